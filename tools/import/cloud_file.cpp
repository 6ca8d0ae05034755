#include "tools/import/cloud_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "common/scene_limits.h"

namespace brume::volumes {

namespace {

// The mean of a vector at the voxels in a kernel's cell, or at the nearest around it, weighted by their values.
std::optional<glm::vec3> meanOf(const std::vector<glm::vec3>& vectors, const Volume& volume, const Kernel& kernel) {
    const int half = std::max(1 << kernel.level >> 1, 1);
    const glm::ivec3 middle(glm::round(kernel.at));
    glm::dvec3 sum(0);
    double all = 0;
    for (int x = middle.x - half; x <= middle.x + half; ++x)
        for (int y = middle.y - half; y <= middle.y + half; ++y)
            for (int z = middle.z - half; z <= middle.z + half; ++z) {
                const uint32_t block = volume.voxels.find(glm::ivec3(x, y, z) >> 3);
                if (block == kNoBlock) continue;
                const size_t i = block * kInBlock + inBlock({x, y, z});
                sum += double(volume.voxels.values()[i]) * glm::dvec3(vectors[i]);
                all += double(volume.voxels.values()[i]);
            }
    return all > 0 ? std::optional(glm::vec3(sum / all)) : std::nullopt;
}

void check(const char* what, const char* unit, double value, Limits allowed, const char* remedy) {
    if (!allowed.holds(value))
        throw ImportError(fmt::format("a particle's {} would be {:g} {}; allowed: {:g} to {:g}: {}", what, value, unit,
                                      allowed.lo, allowed.hi, remedy));
}

template <class T>
void append(std::string& bytes, T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T)); // little-endian, as all machines that brume runs on
    bytes.append(raw, sizeof(T));
}

} // namespace

double depthPerValue(const Volume& volume, const Placing& placing) {
    return placing.density * volume.width * placing.scale;
}

void CellIds::begin(const Volume& volume) {
    if (volume.turn != turn_ || volume.origin != origin_) ids_.clear();
    turn_ = volume.turn;
    origin_ = volume.origin;
}

int32_t CellIds::of(const Kernel& kernel) {
    const auto [place, is_new] = ids_.try_emplace({kernel.level, kernel.cell.x, kernel.cell.y, kernel.cell.z}, next_);
    if (is_new) ++next_;
    return place->second;
}

Cloud cloudOf(const Volume& volume, const std::vector<Kernel>& kernels, const Placing& placing, CellIds* ids) {
    Cloud out;
    out.coloured = !volume.albedo.empty();
    out.has_velocities = ids && !volume.velocity.empty();
    out.has_ids = ids && !out.has_velocities;
    out.has_axes = !std::ranges::all_of(kernels, isBall);
    if (ids) ids->begin(volume);
    const glm::dmat3 turn = volume.turn / volume.width; // of a direction
    for (const Kernel& kernel : kernels) {
        const auto turned = [&](glm::dvec3 v) { return placing.z_up ? glm::dvec3(v.x, v.z, -v.y) : v; };
        const glm::dvec3 at = turned((volume.origin + volume.turn * kernel.at) * placing.scale);
        const PrincipalAxes axes = principalAxes(trueSpread(kernel));
        const glm::dvec3 deviation = axes.deviation; // voxels
        const double longest = std::max({deviation.x, deviation.y, deviation.z});
        const double volume_of = std::pow(2 * std::numbers::pi, 1.5) * deviation.x * deviation.y * deviation.z;
        const double sigma_t = placing.density * double(kernel.mass) / volume_of;
        const double scale = 10 * longest * volume.width * placing.scale / placing.falloff;
        check("scale", "m", scale, limits::kScale, "another --scale");
        check("extinction", "1/m", sigma_t, limits::kSigmaT, "a lower --density");
        for (int axis = 0; axis < 3; ++axis) check("place", "m", at[axis], limits::kPlace, "a lower --scale");
        Cloud::Point& point = out.points.emplace_back();
        point = {.at = glm::vec3(at), .scale = float(scale), .sigma_t = float(sigma_t)};
        if (out.coloured) point.albedo = meanOf(volume.albedo, volume, kernel).value_or(glm::vec3(1));
        if (out.has_velocities)
            point.velocity =
                turned(meanOf(volume.velocity, volume, kernel).value_or(glm::vec3(0)) * float(placing.scale));
        if (out.has_ids) point.id = ids->of(kernel);
        for (int axis = 0; axis < 3; ++axis)
            point.axes[axis] = glm::vec3(turned(turn * axes.unit[axis]) * (deviation[axis] / longest));
    }
    return out;
}

void writeCloud(const std::filesystem::path& file, const Cloud& cloud, const std::vector<std::string>& comments) {
    std::string bytes = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& comment : comments) bytes += "comment " + comment + '\n';
    bytes += fmt::format("element vertex {}\n", cloud.points.size());
    for (const char* const name : {"x", "y", "z", "scale", "sigma_t"})
        bytes += fmt::format("property float {}\n", name);
    if (cloud.coloured)
        for (const char* const name : {"red", "green", "blue"}) bytes += fmt::format("property float {}\n", name);
    if (cloud.has_axes)
        for (const char axis : {'a', 'b', 'c'})
            for (const char along : {'x', 'y', 'z'}) bytes += fmt::format("property float axis_{}_{}\n", axis, along);
    if (cloud.has_velocities) bytes += "property float vx\nproperty float vy\nproperty float vz\n";
    if (cloud.has_ids) bytes += "property int id\n";
    bytes += "end_header\n";
    for (const Cloud::Point& point : cloud.points) {
        for (int axis = 0; axis < 3; ++axis) append(bytes, point.at[axis]);
        append(bytes, point.scale);
        append(bytes, point.sigma_t);
        for (int channel = 0; cloud.coloured && channel < 3; ++channel) append(bytes, point.albedo[channel]);
        for (int n = 0; cloud.has_axes && n < 9; ++n) append(bytes, point.axes[n / 3][n % 3]);
        for (int axis = 0; cloud.has_velocities && axis < 3; ++axis) append(bytes, point.velocity[axis]);
        if (cloud.has_ids) append(bytes, point.id);
    }
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), std::streamsize(bytes.size()));
    out.close();
    if (!out) throw ImportError(file.string() + ": cannot be written");
}

} // namespace brume::volumes
