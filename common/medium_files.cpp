#include "common/medium_files.h"

#include <mutex>
#include <utility>

#include "common/ply/ply.h"
#include "common/scene_limits.h"
#include "common/tetrahedra.h"
#include "common/volume/volume.h"

namespace brume {
namespace {

// What `load` makes of a medium's file. That of a file that is still in use is not read again while it is the same: a
// server reads a scene several times, and half a million tetrahedra take seconds.
template <class T, class Load>
std::shared_ptr<const T> keptOf(const Medium& medium, const glm::dvec3& origin, const Load& load) {
    struct Source {
        std::filesystem::path file;
        uintmax_t bytes = 0;
        std::filesystem::file_time_type changed;
        PlyFrame frame;
        bool operator==(const Source&) const = default;
    };
    static std::mutex mutex;
    static Source last;
    static std::weak_ptr<const T> kept;
    std::error_code error;
    const Source now{medium.file, std::filesystem::file_size(medium.file, error),
                     std::filesystem::last_write_time(medium.file, error), frameOf(medium, origin)};
    const std::scoped_lock lock(mutex);
    if (!error && now == last)
        if (auto same = kept.lock()) return same;
    auto read = std::make_shared<const T>(load(now.frame));
    last = now, kept = read;
    return read;
}

} // namespace

std::shared_ptr<const Tetrahedra> tetrahedraOf(const Medium& medium, const glm::dvec3& origin) {
    if (medium.model != kTetrahedraMedium) return nullptr;
    return keptOf<Tetrahedra>(medium, origin, [&](const PlyFrame& frame) {
        PointCloud cloud = loadPly(medium.file, frame, {.tetrahedra = true});
        return connected(std::move(cloud.tetrahedra), cloud.position, medium.file.string(), cloud.vertex);
    });
}

std::shared_ptr<const Volume> volumeOf(const Medium& medium, const glm::dvec3& origin) {
    if (medium.layout != Layout::volume) return nullptr;
    return keptOf<Volume>(medium, origin, [&](const PlyFrame& frame) {
        return loadVolume(medium.file, frame, uint64_t(limits::kVolumeNodes.hi));
    });
}

} // namespace brume
