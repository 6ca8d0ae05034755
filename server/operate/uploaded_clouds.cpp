#include "server/operate/uploaded_clouds.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "common/plain_file.h"
#include "common/scene.h"
#include "server/sim/state_hash.h"

namespace brume {
namespace {

namespace fs = std::filesystem;

constexpr const char* kIncoming = "incoming";     // folder of those that are not known to be good
constexpr std::string_view kOwnFolder = "XXXXXX"; // as mkdtemp() has it

// The first line of a scene that the server wrote, of this text and the cloud's file.
std::string markOf(const std::string& text, const fs::path& cloud) {
    std::error_code error;
    const uintmax_t bytes = fs::file_size(cloud, error);
    const fs::file_time_type written = fs::last_write_time(cloud, error);
    return fmt::format("# Written for an uploaded cloud: {:016x} {} {}\n", hashOf(text, 0), bytes,
                       written.time_since_epoch().count());
}

constexpr std::array kEndings{".ply", ".nrrd"};

fs::path besideOf(const fs::path& scene, const std::string& ending) {
    return fs::path(scene).replace_extension(ending);
}

// True: the server wrote the scene and its cloud, and nobody has changed them.
bool isOurs(const fs::path& scene) {
    std::ifstream in = openPlain(scene);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const size_t begin = std::min(text.find('\n'), text.size() - 1) + 1;
    return std::ranges::any_of(kEndings, [&](const char* ending) {
        return text.starts_with(markOf(text.substr(begin), besideOf(scene, ending)));
    });
}

[[noreturn]] void cannotWrite(const fs::path& file) {
    throw SceneError(file.string() + ": cannot be written; --cloud-dir names another folder");
}

void write(const fs::path& file, const std::string& bytes) {
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out << bytes << std::flush;
    if (!out) cannotWrite(file);
}

// True: there is a file of that name, or a link, wherever it leads.
bool isTaken(const fs::path& file) {
    std::error_code error;
    return fs::exists(fs::symlink_status(file, error));
}

// A new folder, so that nothing of others is in it.
fs::path ownFolder(const fs::path& parent) {
    std::error_code error;
    fs::create_directories(parent, error);
    std::string name = (parent / kOwnFolder).string();
    if (!::mkdtemp(name.data())) cannotWrite(parent);
    return name;
}

// What cannot be deleted stays.
void keepNewest(const fs::path& folder) {
    std::error_code ignored;
    std::vector<std::pair<fs::file_time_type, fs::path>> scenes;
    for (const auto& entry : fs::directory_iterator(folder, ignored))
        if (entry.path().extension() == ".toml" && isOurs(entry.path()))
            scenes.emplace_back(entry.last_write_time(ignored), entry.path());
    std::ranges::sort(scenes);
    for (size_t i = 0; i + UploadedClouds::kMost < scenes.size(); ++i) {
        fs::remove(scenes[i].second, ignored);
        for (const char* ending : kEndings) fs::remove(besideOf(scenes[i].second, ending), ignored);
    }
}

} // namespace

UploadedClouds::Incoming::Incoming(const fs::path& folder, const std::string& name, const std::string& bytes,
                                   const std::string& ending)
    : kept_(folder / (name + ".toml")), bytes_(ownFolder(folder / kIncoming) / (name + ending)) {
    try {
        write(bytes_, bytes);
    } catch (const SceneError&) {
        discard();
        throw;
    }
}

void UploadedClouds::Incoming::discard() const {
    std::error_code ignored;
    fs::remove_all(bytes_.parent_path(), ignored);
}

fs::path UploadedClouds::Incoming::scene() const { return fs::path(bytes_).replace_extension(".toml"); }

fs::path UploadedClouds::Incoming::keep(const std::string& text) {
    write(scene(), markOf(text, bytes_) + text);
    std::error_code error;
    const std::string own = bytes_.extension().string();
    fs::rename(bytes_, besideOf(kept_, own), error);
    if (!error) fs::rename(scene(), kept_, error);
    if (error) throw SceneError(kept_.string() + ": cannot be written: " + error.message());
    std::error_code ignored;
    for (const char* ending : kEndings) // an older cloud of this name may be of the other kind
        if (ending != own) fs::remove(besideOf(kept_, ending), ignored);
    keepNewest(kept_.parent_path());
    return kept_;
}

UploadedClouds::Incoming UploadedClouds::take(const std::string& name, const std::string& bytes,
                                              const std::string& ending) const {
    const fs::path kept = folder_ / (name + ".toml");
    const bool taken =
        isTaken(kept) || std::ranges::any_of(kEndings, [&](const char* of) { return isTaken(besideOf(kept, of)); });
    if (taken && !isOurs(kept))
        throw SceneError("there is a '" + name +
                         "' in --cloud-dir that this server did not upload, or that was changed: " +
                         "give another name with ?name=, or remove it there");
    return {folder_, name, bytes, ending};
}

std::string UploadedClouds::withoutFolders(std::string complaint) const {
    const std::string incoming = (folder_ / kIncoming / "").string(), kept = (folder_ / "").string();
    const auto erase = [&](const std::string& folder, size_t more) {
        for (size_t at = 0; (at = complaint.find(folder, at)) != complaint.npos;)
            complaint.erase(at, folder.size() + more);
    };
    erase(incoming, kOwnFolder.size() + 1);
    erase(kept, 0);
    return complaint;
}

} // namespace brume
