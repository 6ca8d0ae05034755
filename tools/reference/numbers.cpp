#include "tools/reference/numbers.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace brume::reference {

uint64_t Numbers::hash() const { return XXH3_64bits(all_.data(), all_.size() * sizeof(double)); }

void Numbers::add(glm::dvec3 v) { all_.insert(all_.end(), {v.x, v.y, v.z}); }

void Numbers::add(const Blob& blob) {
    const auto& [centre, scale, k, sigma_t, half_line, albedo] = blob;
    add(centre), add(scale), add(k), add(sigma_t), add(half_line), add(albedo);
}

void Numbers::add(const UnionMedium::Ball& ball) {
    const auto& [centre, radius] = ball;
    add(centre), add(radius);
}

void Numbers::add(const UnionMedium& medium) {
    const auto& [balls, sigma_t, albedo] = medium;
    add(balls), add(sigma_t), add(albedo);
}

void Numbers::add(const VoxelMedium& medium) {
    const auto& [volume, origin, times, albedo] = medium;
    add(origin), add(times), add(albedo), add(glm::dvec3(volume->size)), add(volume->spacing);
    for (const float extinction : volume->extinction) add(double(extinction));
}

void Numbers::add(const SemiAxes& axes) {
    const auto& [a, b, c] = axes;
    add(a), add(b), add(c);
}

void Numbers::add(const TetrahedralMedium::Corner& corner) {
    const auto& [place, sigma_t, albedo] = corner;
    add(place), add(sigma_t), add(albedo);
}

void Numbers::add(const glm::uvec4& cell) {
    for (int i = 0; i < 4; ++i) add(double(cell[i]));
}

void Numbers::add(const TetrahedralMedium& medium) {
    const auto& [corners, cells] = medium;
    add(corners), add(cells);
}

void Numbers::add(const Fog& fog) {
    const auto& [sigma_t, albedo, falloff, lo, hi, centre, radius, base, phase, emission, colour] = fog;
    add(sigma_t), add(albedo), add(falloff), add(lo), add(hi), add(centre), add(radius), add(base);
    add(phase), add(emission);
    if (colour != glm::dvec3(1)) add(colour);
}

void Numbers::add(const LightSource& light) {
    const auto& [kind, colour, to_light, position, axis, cos_outer, cos_inner, radius, range, shadows] = light;
    add(double(kind)), add(colour), add(to_light), add(position), add(axis), add(cos_outer), add(cos_inner);
    add(radius), add(range), add(double(shadows));
}

void Numbers::add(const Obstacle& obstacle) {
    const auto& [kind, centre, half_size, yaw, albedo, corners, beyond, structure, structure_size] =
        obstacle; // `beyond` follows from corners
    add(double(kind)), add(centre), add(half_size), add(yaw), add(albedo);
    if (kind == Obstacle::Kind::triangle)
        for (const glm::dvec3& corner : corners) add(corner);
    if (structure > 0) add(structure), add(structure_size);
}

void Numbers::add(const Sheet& sheet) {
    const auto& [centre, across, along, normal, transmittance, reflectance] = sheet;
    add(centre), add(across), add(along), add(normal), add(transmittance), add(reflectance);
}

template <class Element>
void Numbers::add(const std::vector<Element>& list) {
    add(double(list.size()));
    for (const Element& element : list) add(element);
}

void Numbers::add(const World& world) {
    const auto& [blobs, axes, support, cut_light, composition, balls, tetrahedra, voxels, fogs, lights, obstacles,
                 sheets, zenith, horizon, haze, ambient, emission, cold_albedo, phase, colour, sky_lights,
                 onto_surfaces] = world;
    add(blobs), add(double(support)), add(double(cut_light)), add(double(composition)), add(balls), add(fogs);
    add(lights), add(obstacles), add(zenith), add(horizon), add(haze), add(ambient), add(phase);
    if (colour != glm::dvec3(1)) add(colour);
    if (emission != glm::dvec3(0)) add(emission), add(cold_albedo);
    if (!sheets.empty()) add(sheets);
    if (!axes.empty()) add(axes);
    if (voxels.volume) add(voxels);
    if (!tetrahedra.cells.empty()) add(tetrahedra);
    if (sky_lights) add(1.0);
    if (onto_surfaces) add(2.0);
}

void Numbers::add(const Camera& camera) {
    const auto& [width, height, position, world_from_view, orthographic, half_height, near_depth] = camera;
    add(double(width)), add(double(height)), add(position);
    for (int i = 0; i < 3; ++i) add(world_from_view[i]);
    add(double(orthographic)), add(half_height), add(near_depth);
}

void Numbers::add(const PhaseLobes& phase) {
    const auto& [part, asymmetry, draine, second] = phase;
    add(part), add(asymmetry), add(draine), add(second);
}

void Numbers::add(const Frustum& frustum) {
    const auto& [left, right, up, down] = frustum;
    add(left), add(right), add(up), add(down);
}

void Numbers::add(const Pose& pose) {
    const auto& [position, orientation, fov_y, eye_separation, frustum, right_frustum] = pose;
    add(glm::dvec3(position));
    for (int i = 0; i < 4; ++i) add(double(orientation[i]));
    add(fov_y), add(eye_separation), add(frustum), add(right_frustum);
}

} // namespace brume::reference
