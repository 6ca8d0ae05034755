// brume-export: clouds of particles as volumes.
#include <chrono>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "client/native/http_get.h"
#include "common/option_range.h"
#include "common/ply/ply.h"
#include "common/scene_limits.h"
#include "tools/import/export.h"
#include "tools/import/volume.h"

namespace {

using namespace brume;

constexpr std::chrono::minutes kWithin{2};

bool isServer(const std::string& in) { return in.starts_with("http://") || in.starts_with("https://"); }

void exportFrom(const std::string& page, const std::string& token_file, const std::string& ca,
                const volumes::ExportSettings& settings, const volumes::Say& say) {
    client::Endpoint server = client::parseUrl(page);
    server.token = client::readToken(token_file);
    server.ca = ca;
    const std::string path = server.path.substr(0, server.path.rfind('/') + 1) + "particles.ply"; // beside the socket
    const std::string name = page.substr(0, page.find_first_of("/?#", page.find("//") + 2)) + path;
    std::string bytes;
    try {
        bytes = client::httpGet(server, path, kWithin, kMostPlyBytes);
    } catch (const std::runtime_error& error) {
        throw volumes::ImportError(name + " cannot be had: " + error.what());
    }
    volumes::exportBytes(bytes, name, settings, say);
}

} // namespace

int main(int argc, char** argv) {
    volumes::ExportSettings settings;
    std::string in, token_file, ca, up = "y";
    CLI::App app{
        "brume-export: a PLY file of particles as a VDB volume: grid density (1/m), and albedo if there is one.\n"
        "Or, as out.nrrd, its extinctions alone, for medium.layout = \"volume\". Particles with axes are ellipsoids.\n"
        "With a # for each digit of a number all frames (plume-######.ply out-####.vdb)."};
    app.set_version_flag("--version", BRUME_VERSION);
    app.add_option("in", in, "a PLY file, or a server: http://host:port, whose particles of this tick are fetched")
        ->required();
    app.add_option("out", settings.out, "a VDB file, or a NRRD file")->required();
    allow(app.add_option("--voxel", settings.voxel, "width of a voxel, m")->capture_default_str(), 1e-4, 1e3);
    allow(app.add_option("--least", settings.least, "extinction (1/m) of a voxel that is left out")
              ->capture_default_str(),
          0.0, 1e3);
    allow(app.add_option("--falloff", settings.falloff,
                         "medium.falloff of the scene; otherwise what a comment of the file says, or 1.6"),
          limits::kFalloff.lo, limits::kFalloff.hi);
    app.add_option("--up", up, "the volume's upward axis")->check(CLI::IsMember({"y", "z"}))->capture_default_str();
    app.add_option("--token-file", token_file,
                   "file with the token that lets in, of an operator; without it BRUME_TOKEN");
    app.add_option("--ca", ca, "PEM file of who vouches for an https:// server, instead of whom the system trusts");
    CLI11_PARSE(app, argc, argv);
    settings.in = in;
    settings.z_up = up == "z";
    const auto say = [](const std::string& line) { std::printf("%s\n", line.c_str()); };
    try {
        if (isServer(in))
            exportFrom(in, token_file, ca, settings, say);
        else
            volumes::exportFiles(settings, say);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "brume-export: %s\n", e.what());
        return 1;
    }
}
