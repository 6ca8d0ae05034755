#include "server/operate/uploaded_clouds.h"

#include <algorithm>
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

// The first line of a scene that the server wrote, of this text and these points.
std::string markOf(const std::string& text, const fs::path& points) {
    std::error_code error;
    const uintmax_t bytes = fs::file_size(points, error);
    const fs::file_time_type written = fs::last_write_time(points, error);
    return fmt::format("# Written for an uploaded cloud: {:016x} {} {}\n", hashOf(text, 0), bytes,
                       written.time_since_epoch().count());
}

fs::path pointsOf(const fs::path& scene) { return fs::path(scene).replace_extension(".ply"); }

// True: the server wrote the scene and its points, and nobody has changed them.
bool isOurs(const fs::path& scene) {
    std::ifstream in = openPlain(scene);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const size_t begin = std::min(text.find('\n'), text.size() - 1) + 1;
    return text.starts_with(markOf(text.substr(begin), pointsOf(scene)));
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
        fs::remove(pointsOf(scenes[i].second), ignored);
    }
}

} // namespace

UploadedClouds::Incoming::Incoming(const fs::path& folder, const std::string& name, const std::string& points)
    : kept_(folder / (name + ".toml")), points_(ownFolder(folder / kIncoming) / (name + ".ply")) {
    try {
        write(points_, points);
    } catch (const SceneError&) {
        discard();
        throw;
    }
}

void UploadedClouds::Incoming::discard() const {
    std::error_code ignored;
    fs::remove_all(points_.parent_path(), ignored);
}

fs::path UploadedClouds::Incoming::scene() const { return fs::path(points_).replace_extension(".toml"); }

fs::path UploadedClouds::Incoming::keep(const std::string& text) {
    write(scene(), markOf(text, points_) + text);
    std::error_code error;
    fs::rename(points_, pointsOf(kept_), error);
    if (!error) fs::rename(scene(), kept_, error);
    if (error) throw SceneError(kept_.string() + ": cannot be written: " + error.message());
    keepNewest(kept_.parent_path());
    return kept_;
}

UploadedClouds::Incoming UploadedClouds::take(const std::string& name, const std::string& points) const {
    const fs::path kept = folder_ / (name + ".toml");
    if ((isTaken(kept) || isTaken(pointsOf(kept))) && !isOurs(kept))
        throw SceneError("there is a '" + name +
                         "' in --cloud-dir that this server did not upload, or that was changed: " +
                         "give another name with ?name=, or remove it there");
    return {folder_, name, points};
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
