#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetUtil.h>

#include "tools/import/volume.h"

namespace brume::volumes {

namespace {

constexpr const char* kAlbedoNames[] = {"albedo", "color", "Cd"}; // brume-export, Blender, Houdini
constexpr const char* kVelocityNames[] = {"velocity", "vel", "v"};

openvdb::Coord coordOf(glm::ivec3 voxel) { return {voxel.x, voxel.y, voxel.z}; }
glm::ivec3 voxelOf(const openvdb::Coord& coord) { return {coord.x(), coord.y(), coord.z()}; }
glm::dvec3 vectorOf(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }

// OpenVDB's own messages have several parts, and at times several lines.
[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
    throw ImportError(file.string() + ": " + why.substr(0, why.find('\n')));
}

struct Names {
    std::vector<std::string> grids, shown; // shown: with their types
};

Names namesIn(openvdb::io::File& file) {
    Names out;
    for (auto name = file.beginName(); name != file.endName(); ++name) {
        out.grids.push_back(name.gridName());
        out.shown.push_back(name.gridName() + " (" + file.readGridMetadata(name.gridName())->valueType() + ")");
    }
    return out;
}

template <class Grid>
openvdb::FloatGrid::Ptr floats(const openvdb::GridBase::Ptr& grid) {
    typename Grid::Ptr typed = openvdb::gridPtrCast<Grid>(grid);
    if constexpr (std::is_same_v<Grid, openvdb::FloatGrid>)
        return typed;
    else {
        auto out = openvdb::FloatGrid::create(0);
        out->setTransform(typed->transformPtr());
        out->setGridClass(typed->getGridClass());
        for (auto value = typed->cbeginValueOn(); value; ++value) {
            if (value.isVoxelValue())
                out->tree().setValue(value.getCoord(), float(*value));
            else
                out->fill(value.getBoundingBox(), float(*value), true);
        }
        return out;
    }
}

// A grid of any scalar type as floats; null: it is of another type.
openvdb::FloatGrid::Ptr asFloats(const openvdb::GridBase::Ptr& grid) {
    if (grid->isType<openvdb::FloatGrid>()) return floats<openvdb::FloatGrid>(grid);
    if (grid->isType<openvdb::DoubleGrid>()) return floats<openvdb::DoubleGrid>(grid);
    if (grid->isType<openvdb::Int32Grid>()) return floats<openvdb::Int32Grid>(grid);
    if (grid->isType<openvdb::Int64Grid>()) return floats<openvdb::Int64Grid>(grid);
    if (grid->isType<openvdb::BoolGrid>()) return floats<openvdb::BoolGrid>(grid);
    return nullptr;
}

// Takes over the place of the grid's voxels, which have to be cubes.
void place(const std::filesystem::path& file, const openvdb::GridBase& grid, Volume& out) {
    if (!grid.transform().isLinear()) refuse(file, "its voxels lie in a frustum; allowed: cubes");
    const auto at = [&](double x, double y, double z) { return vectorOf(grid.indexToWorld(openvdb::Vec3d(x, y, z))); };
    out.origin = at(0, 0, 0);
    const double most = 1e-4; // relative; files have single precision at times
    for (int axis = 0; axis < 3; ++axis) out.turn[axis] = at(axis == 0, axis == 1, axis == 2) - out.origin;
    out.width = glm::length(out.turn[0]);
    for (int axis = 0; axis < 3; ++axis) {
        const double skew = std::abs(glm::dot(out.turn[axis], out.turn[(axis + 1) % 3]));
        if (!(out.width > 0) || std::abs(glm::length(out.turn[axis]) - out.width) > most * out.width ||
            skew > most * out.width * out.width)
            refuse(file, fmt::format("its voxels are {:g} x {:g} x {:g} wide, or skew; allowed: cubes",
                                     glm::length(out.turn[0]), glm::length(out.turn[1]), glm::length(out.turn[2])));
    }
}

// Copies the active values above 0, of voxels and of tiles.
void copy(const openvdb::FloatGrid& grid, Volume& out) {
    std::vector<glm::ivec3> blocks;
    const auto forBlocks = [](const openvdb::CoordBBox& box, const auto& visit) {
        for (int x = box.min().x() >> 3; x <= box.max().x() >> 3; ++x)
            for (int y = box.min().y() >> 3; y <= box.max().y() >> 3; ++y)
                for (int z = box.min().z() >> 3; z <= box.max().z() >> 3; ++z) visit(glm::ivec3(x, y, z));
    };
    // A leaf is a block, and a tile is several whole ones.
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) blocks.push_back(voxelOf(leaf->origin()) >> 3);
    auto tiles = grid.cbeginValueOn();
    tiles.setMaxDepth(openvdb::FloatTree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tiles; ++tiles)
        if (*tiles > 0) forBlocks(tiles.getBoundingBox(), [&](glm::ivec3 block) { blocks.push_back(block); });
    out.voxels = Voxels(std::move(blocks));
    const std::span<float> values = out.voxels.values();
    uint64_t negative = 0, broken = 0;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
        float* const to = &values[out.voxels.find(voxelOf(leaf->origin()) >> 3) * kInBlock];
        for (auto value = leaf->cbeginValueOn(); value; ++value) {
            if (!std::isfinite(*value))
                ++broken;
            else if (*value < 0)
                ++negative;
            else
                to[inBlock(voxelOf(value.getCoord()))] = *value;
        }
    }
    tiles = grid.cbeginValueOn();
    tiles.setMaxDepth(openvdb::FloatTree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tiles; ++tiles)
        if (*tiles > 0 && std::isfinite(*tiles))
            forBlocks(tiles.getBoundingBox(), [&](glm::ivec3 block) {
                std::fill_n(&values[out.voxels.find(block) * kInBlock], kInBlock, *tiles);
            });
    out.voxels.finish();
    if (negative > 0) out.notes.push_back(fmt::format("{} negative values are taken as 0", negative));
    if (broken > 0) out.notes.push_back(fmt::format("{} values are not finite and taken as 0", broken));
}

// A grid's vectors at the voxels above 0.
std::vector<glm::vec3> sampled(const openvdb::Vec3SGrid& grid, const Volume& at_voxels) {
    std::vector<glm::vec3> out(at_voxels.voxels.values().size(), glm::vec3(0));
    // The accessor outlives the sampler, which points to it.
    const openvdb::Vec3SGrid::ConstAccessor accessor = grid.getConstAccessor();
    const openvdb::tools::GridSampler<openvdb::Vec3SGrid::ConstAccessor, openvdb::tools::BoxSampler> sampler(
        accessor, grid.transform());
    for (size_t i = 0; i < out.size(); ++i) {
        if (!(at_voxels.voxels.values()[i] > 0)) continue;
        const glm::ivec3 voxel = volumes::voxelOf(at_voxels.voxels.blocks()[i / kInBlock], i % kInBlock);
        const glm::dvec3 at = at_voxels.origin + at_voxels.turn * glm::dvec3(voxel);
        const openvdb::Vec3s value = sampler.wsSample(openvdb::Vec3d(at.x, at.y, at.z));
        for (int axis = 0; axis < 3; ++axis) out[i][axis] = std::isfinite(value[axis]) ? value[axis] : 0;
    }
    return out;
}

// The name of a grid of vectors that is wanted; empty: there is none.
std::string nameOf(const std::filesystem::path& file, const Names& names, const std::string& wanted,
                   std::span<const char* const> usual, const char* option) {
    const auto there = [&](const std::string& name) {
        return std::ranges::find(names.grids, name) != names.grids.end();
    };
    if (wanted == "none") return {};
    if (wanted.empty()) {
        for (const char* const name : usual)
            if (there(name)) return name;
        return {};
    }
    if (!there(wanted))
        refuse(file, fmt::format("no grid {} for {}; there are: {}", wanted, option, fmt::join(names.shown, ", ")));
    return wanted;
}

} // namespace

Volume readVolume(const std::filesystem::path& path, const VolumeWanted& wanted) try {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) refuse(path, "no such file");
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.setCopyMaxBytes(0);
    file.open(false);
    const Names names = namesIn(file);
    if (std::ranges::find(names.grids, wanted.grid) == names.grids.end())
        refuse(path, fmt::format("no grid {}; there are: {}", wanted.grid,
                                 names.shown.empty() ? "none" : fmt::format("{}", fmt::join(names.shown, ", "))));
    const openvdb::GridBase::Ptr raw = file.readGrid(wanted.grid);
    if (raw->activeVoxelCount() > kMostVoxels)
        refuse(path, fmt::format("grid {} has {} active voxels; allowed: {}", wanted.grid, raw->activeVoxelCount(),
                                 kMostVoxels));
    openvdb::FloatGrid::Ptr grid = asFloats(raw);
    if (!grid)
        refuse(path, fmt::format("grid {} is of type {}; allowed: one number a voxel", wanted.grid, raw->valueType()));
    Volume out;
    place(path, *grid, out);
    if (grid->getGridClass() == openvdb::GRID_LEVEL_SET) {
        grid = grid->deepCopy();
        openvdb::tools::sdfToFogVolume(*grid);
        out.notes.push_back("the level set becomes a fog: 1 inside, less within its band");
        if (grid->activeVoxelCount() > kMostVoxels)
            refuse(path,
                   fmt::format("the fog has {} active voxels; allowed: {}", grid->activeVoxelCount(), kMostVoxels));
    }
    const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
    if (!box.empty() &&
        (box.min() < coordOf(glm::ivec3(-kFarthest / 2)) || coordOf(glm::ivec3(kFarthest / 2)) < box.max()))
        refuse(path, fmt::format("a voxel lies more than {} voxels from the file's origin", kFarthest / 2));
    if (grid->background() > 0 && grid->getGridClass() != openvdb::GRID_LEVEL_SET)
        out.notes.push_back("the background's value is taken as 0");
    copy(*grid, out);
    if (out.voxels.active() == 0) refuse(path, fmt::format("grid {} has no voxel above 0", wanted.grid));
    const auto vectors = [&](const std::string& name) -> std::vector<glm::vec3> {
        if (name.empty()) return {};
        if (const auto found = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid(name)))
            return sampled(*found, out);
        out.notes.push_back(fmt::format("grid {} is no vec3s and ignored", name));
        return {};
    };
    const std::string albedo = nameOf(path, names, wanted.albedo, kAlbedoNames, "--albedo");
    const std::string velocity = nameOf(path, names, wanted.velocity, kVelocityNames, "--velocity");
    out.albedo = vectors(albedo);
    for (glm::vec3& colour : out.albedo) colour = glm::clamp(colour, 0.0f, 1.0f);
    out.velocity = vectors(velocity);
    for (const std::string& name : names.grids)
        if (name != wanted.grid && name != albedo && name != velocity)
            out.notes.push_back(fmt::format("grid {} is ignored", name));
    return out;
} catch (const openvdb::Exception& e) {
    refuse(path, fmt::format("cannot be read as VDB: {}", e.what()));
}

void writeVolume(const std::filesystem::path& path, const Volume& volume) try {
    openvdb::initialize();
    const glm::dmat3& t = volume.turn;
    const glm::dvec3& o = volume.origin;
    // Rows, as OpenVDB multiplies vectors from the left.
    const openvdb::math::Mat4d matrix(t[0].x, t[0].y, t[0].z, 0., t[1].x, t[1].y, t[1].z, 0., t[2].x, t[2].y, t[2].z,
                                      0., o.x, o.y, o.z, 1.);
    const auto transform = openvdb::math::Transform::createLinearTransform(matrix);
    const auto density = openvdb::FloatGrid::create(0);
    const auto albedo = openvdb::Vec3SGrid::create(), velocity = openvdb::Vec3SGrid::create();
    density->setName("density");
    density->setGridClass(openvdb::GRID_FOG_VOLUME);
    albedo->setName("albedo");
    velocity->setName("velocity");
    density->setTransform(transform), albedo->setTransform(transform), velocity->setTransform(transform);
    auto densities = density->getAccessor();
    auto albedos = albedo->getAccessor(), velocities = velocity->getAccessor();
    for (size_t i = 0; i < volume.voxels.values().size(); ++i) {
        const float value = volume.voxels.values()[i];
        if (!(value > 0)) continue;
        const openvdb::Coord at = coordOf(volumes::voxelOf(volume.voxels.blocks()[i / kInBlock], i % kInBlock));
        densities.setValue(at, value);
        if (!volume.albedo.empty()) albedos.setValue(at, {volume.albedo[i].x, volume.albedo[i].y, volume.albedo[i].z});
        if (!volume.velocity.empty())
            velocities.setValue(at, {volume.velocity[i].x, volume.velocity[i].y, volume.velocity[i].z});
    }
    openvdb::GridPtrVec grids{density};
    if (!volume.albedo.empty()) grids.push_back(albedo);
    if (!volume.velocity.empty()) grids.push_back(velocity);
    openvdb::io::File file(path.string());
    file.write(grids);
    file.close();
} catch (const openvdb::Exception& e) {
    refuse(path, fmt::format("cannot be written: {}", e.what()));
}

} // namespace brume::volumes
