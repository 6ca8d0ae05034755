#include "common/ply/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/ellipsoid.h"
#include "common/plain_file.h"
#include "common/ply/axes.h"
#include "common/ply/cells.h"
#include "common/ply/extent.h"
#include "common/ply/points.h"
#include "common/scene.h"
#include "common/scene_limits.h"
#include "common/text.h"

namespace brume {

namespace {

using ply::Cells, ply::Element, ply::Points, ply::Reader, ply::Slot;

constexpr Limits kVelocity{-1e4, 1e4};                      // m/s
constexpr size_t kLongestElement = 40, kLongestNames = 200; // bytes of a name and of many, in notes

// What a slot's number may be, once it is in the scene's unit.
struct Rule {
    Slot slot;
    std::string_view name;
    Limits allowed;
    int lengths; // the unit's power in it
};
constexpr Rule kRules[]{{ply::kX, "x", limits::kPlace, 1},
                        {ply::kY, "y", limits::kPlace, 1},
                        {ply::kZ, "z", limits::kPlace, 1},
                        {ply::kScale, "scale", limits::kScale, 1},
                        {ply::kRadius, "radius", limits::kScale, 1},
                        {ply::kDeviation, "size", {0, limits::kScale.hi}, 1},
                        {ply::kSigmaT, "sigma_t", limits::kSigmaT, -1},
                        {ply::kOpacity, "opacity", limits::kColour, 0},
                        {ply::kRed, "red", limits::kColour, 0},
                        {ply::kGreen, "green", limits::kColour, 0},
                        {ply::kBlue, "blue", limits::kColour, 0},
                        {ply::kId, "id", {-2147483648.0, 4294967295.0}, 0},
                        {ply::kVX, "vx", kVelocity, 1},
                        {ply::kVY, "vy", kVelocity, 1},
                        {ply::kVZ, "vz", kVelocity, 1}};

using Point = std::array<double, ply::kSlots>;

// Brings points to a frame.
class Framing {
public:
    Framing(const Points& points, const PlyFrame& frame) : points_(points), frame_(frame) {}

    Point at(size_t i) const {
        Point point{};
        for (const Rule& rule : kRules) {
            if (!points_.has(rule.slot)) continue;
            const double unit = rule.lengths == 0 ? 1 : rule.lengths > 0 ? frame_.unit : 1 / frame_.unit;
            point[rule.slot] = points_.columns[rule.slot][i] * unit;
        }
        const glm::dvec3 place =
            ply::turned({point[ply::kX], point[ply::kY], point[ply::kZ]}, frame_.up) - frame_.origin;
        const glm::dvec3 velocity = ply::turned({point[ply::kVX], point[ply::kVY], point[ply::kVZ]}, frame_.up);
        for (int axis = 0; axis < 3; ++axis) {
            point[ply::kX + size_t(axis)] = place[axis];
            point[ply::kVX + size_t(axis)] = velocity[axis];
        }
        return point;
    }

    // Empty if the point can be used; otherwise which of its numbers is out of range.
    std::string problemOf(const Point& point) const {
        for (const Rule& rule : kRules) {
            const double x = point[rule.slot], whole = points_.whole[rule.slot];
            if (!points_.has(rule.slot) || (rule.allowed.holds(x) && (rule.slot != ply::kId || x == std::floor(x))))
                continue;
            if (rule.slot > ply::kZ) // as the file has it
                return fmt::format("{} is {:.12g}; allowed: {} to {}{}", rule.name, x * whole, rule.allowed.lo * whole,
                                   rule.allowed.hi * whole, rule.slot == ply::kId ? ", whole numbers" : "");
            return fmt::format(
                "{} is {}; allowed: finite, within 50 km of the scene's origin; origin = \"auto\" at its "
                "top is near the points",
                rule.name, x + frame_.origin[int(rule.slot)]);
        }
        return {};
    }

private:
    const Points& points_;
    const PlyFrame& frame_;
};

// The points in the frame, without those that cannot be used.
void addPoints(Reader& in, Points&& points, const PlyFrame& frame, PlyWanted wanted, PointCloud& out) {
    const Framing framing(points, frame);
    const PlyExtent extent = wanted.tetrahedra ? PlyExtent() : ply::extentOf(points, frame.up);
    const auto add = [&](std::vector<float>& to, Slot slot, const Point& point) {
        if (points.has(slot)) to.push_back(static_cast<float>(point[slot]));
    };
    const auto drop = [&](size_t i, const std::string& problem) {
        const std::string why = fmt::format("{}: {}", in.rowName(points.rows[i]), problem);
        if (wanted.tetrahedra) in.fail("a corner of tetrahedra cannot be left out: " + why);
        if (out.dropped++ == 0) out.first_dropped = why;
    };
    if (wanted.axes)
        for (size_t slot = ply::kAxisAX; slot <= ply::kAxisCZ; ++slot)
            if (!points.has(Slot(slot)) && points.count() > 0)
                in.fail("medium.model = \"ellipsoids\", but element vertex lacks axes; expected axis_a_x, axis_a_y ... "
                        "axis_c_z, or Gaussian splats");
    out.ignored = std::move(points.ignored);
    out.notes.insert(out.notes.end(), points.notes.begin(), points.notes.end());
    for (size_t i = 0; i < points.count(); ++i) {
        if (wanted.drop_far && ply::isFar(extent, ply::placeOf(points, i, frame.up))) continue;
        Point point = framing.at(i);
        if (const std::string problem = framing.problemOf(point); !problem.empty()) {
            drop(i, problem);
            continue;
        }
        if (wanted.axes) {
            ply::PointAxes axes = ply::axesOf(points, i, frame.up);
            if (!axes.problem.empty()) {
                drop(i, axes.problem);
                continue;
            }
            for (const Slot size : {ply::kScale, ply::kRadius})
                point[size] = limits::kScale.clamp(float(point[size] * axes.longest));
            point[ply::kSigmaT] *= axes.volume;
            out.axes.push_back(axes.axes);
        }
        out.position.emplace_back(point[ply::kX], point[ply::kY], point[ply::kZ]);
        add(out.scale, ply::kScale, point);
        add(out.radius, ply::kRadius, point);
        add(out.deviation, ply::kDeviation, point);
        add(out.sigma_t, ply::kSigmaT, point);
        add(out.opacity, ply::kOpacity, point);
        if (points.has(ply::kId)) out.id.push_back(static_cast<int64_t>(point[ply::kId]));
        if (points.has(ply::kVX)) out.velocity.emplace_back(point[ply::kVX], point[ply::kVY], point[ply::kVZ]);
        if (points.has(ply::kRed)) out.albedo.emplace_back(point[ply::kRed], point[ply::kGreen], point[ply::kBlue]);
    }
    const char* const them = extent.far == 1 ? "it" : "them";
    if (extent.far > 0)
        out.notes.push_back(ply::farText(extent, frame.unit) +
                            (wanted.drop_far ? fmt::format(" and left out; far_points = \"keep\" keeps {}", them)
                                             : fmt::format("; medium.far_points = \"drop\" leaves {} out", them)));
}

// Each point gets the extinction of the tetrahedra that have it, on average over their volumes.
void spreadExtinction(const Cells& cells, PointCloud& cloud) {
    std::vector<double> sum(cloud.position.size()), volumes(cloud.position.size());
    for (size_t i = 0; i < cells.corners.size(); ++i) {
        const glm::uvec4& cell = cells.corners[i];
        const glm::dvec3 a(cloud.position[cell.x]), b(cloud.position[cell.y]), c(cloud.position[cell.z]),
            d(cloud.position[cell.w]);
        const double volume = std::abs(glm::dot(glm::cross(b - a, c - a), d - a)) + 1e-30; // times 6; flat ones count
        for (int m = 0; m < 4; ++m) sum[cell[m]] += volume * cells.extinction[i], volumes[cell[m]] += volume;
    }
    for (size_t i = 0; i < sum.size(); ++i)
        cloud.sigma_t.push_back(limits::kSigmaT.clamp(volumes[i] > 0 ? float(sum[i] / volumes[i]) : 0));
    cloud.of_cells = true;
    cloud.notes.push_back("each corner has the mean extinction of its tetrahedra, whose own is " +
                          cells.extinction_name);
}

// Leaves out the elements of points that no tetrahedron has.
template <class T>
void keep(std::vector<T>& list, const std::vector<uint32_t>& kept) {
    if (list.empty()) return;
    for (size_t i = 0; i < kept.size(); ++i) list[i] = list[kept[i]];
    list.resize(kept.size());
}

// Leaves out the points that no tetrahedron has: they belong to nothing that is drawn, wherever they are.
void dropUnused(PointCloud& cloud) {
    constexpr uint32_t kUnused = ~0u;
    std::vector<uint32_t> now(cloud.position.size(), kUnused), kept; // number of each point from now on
    for (const glm::uvec4& cell : cloud.tetrahedra)
        for (int m = 0; m < 4; ++m) now[cell[m]] = 0;
    for (uint32_t i = 0; i < now.size(); ++i) {
        if (now[i] == kUnused) continue;
        now[i] = uint32_t(kept.size());
        kept.push_back(i);
    }
    if (kept.size() == now.size()) return;
    cloud.dropped = now.size() - kept.size();
    cloud.first_dropped =
        fmt::format("vertex {}: no tetrahedron has it", std::ranges::find(now, kUnused) - now.begin());
    for (glm::uvec4& cell : cloud.tetrahedra)
        for (int m = 0; m < 4; ++m) cell[m] = now[cell[m]];
    keep(cloud.position, kept);
    keep(cloud.sigma_t, kept);
    keep(cloud.albedo, kept);
    keep(cloud.id, kept);
    cloud.vertex = std::move(kept);
}

void checkCount(Reader& in, const Element& element, Limits allowed, const char* of) {
    if (!allowed.holds(static_cast<double>(element.count)))
        in.fail(fmt::format("element {} has {} {}; allowed: {:.0f} to {:.0f}", element.name, element.count, of,
                            allowed.lo, allowed.hi));
}

// The element of the points. There is one.
const Element& vertexOf(Reader& in, const ply::Header& header) {
    const Element* const found = in.find(header, "vertex");
    if (!found) in.fail("no element vertex; expected one with x, y, z");
    return *found;
}

// Notes of elements that are not read.
void tellOfOthers(const ply::Header& header, bool tetrahedra, bool packed, std::vector<std::string>& notes) {
    for (const Element& element : header.elements) {
        const bool cells = element.name == "tetrahedron", chunks = element.name == "chunk";
        if (element.name == "vertex" || element.count == 0 || (cells && tetrahedra) || (chunks && packed)) continue;
        notes.push_back(fmt::format("element {}, {}, is ignored{}", ply::shortened(element.name, kLongestElement),
                                    ply::rowsText(element.count),
                                    cells ? "; medium.model = \"tetrahedra\" reads it" : ""));
    }
}

Points pointsOf(Reader& in, const Element& vertex, PlyWanted wanted) {
    if (!wanted.tetrahedra && ply::holdsSplats(vertex)) return ply::readSplats(in, vertex, wanted.axes);
    return ply::readPoints(in, vertex, {wanted.ids, wanted.tetrahedra, wanted.axes, wanted.velocities});
}

} // namespace

std::string plyBytes(const std::filesystem::path& file) {
    std::error_code error;
    const bool regular = std::filesystem::is_regular_file(file, error);
    const uint64_t size = regular ? std::filesystem::file_size(file, error) : 0;
    if (!std::filesystem::exists(file, error) && !error)
        throw SceneError(file.string() + ": PLY: no such file; a relative medium.file counts from the scene's folder");
    std::ifstream in = openPlain(file);
    if (!regular || error || !in)
        throw SceneError(file.string() + ": PLY: cannot be read; expected a point cloud file");
    if (size > kMostPlyBytes) throw SceneError(file.string() + ": PLY: larger than 512 MiB");
    std::string bytes(size, '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(size));
    bytes.resize(static_cast<size_t>(in.gcount()));
    return bytes;
}

PointCloud loadPly(const std::filesystem::path& file, const PlyFrame& frame, PlyWanted wanted) {
    return parsePly(plyBytes(file), file.string(), frame, wanted);
}

PlyContents contentsOf(std::string_view bytes, const std::string& name) {
    Reader in(bytes, name);
    const ply::Header header = readHeader(in);
    const Element* const tetrahedron = header.find("tetrahedron");
    const bool packed = ply::holdsPackedSplats(header);
    const Element& vertex = vertexOf(in, header);
    PlyContents out{.splats = packed || ply::holdsSplats(vertex), .tetrahedra = tetrahedron && tetrahedron->count > 0};
    out.axes = packed || (out.splats ? vertex.has("scale_1") : vertex.has("axis_a_x") && vertex.has("axis_c_z"));
    return out;
}

bool hasEllipsoids(std::string_view bytes, const std::string& name) {
    const PointCloud cloud = parsePly(bytes, name, {}, {.axes = true});
    constexpr float kRound = 0.99f;
    return std::ranges::any_of(cloud.axes, [](const gpu::EllipsoidAxes& one) { return shortestAxis(one) < kRound; });
}

bool holdsPoints(const std::filesystem::path& file) {
    const std::string bytes = plyBytes(file);
    Reader in(bytes, file.string());
    const ply::Header header = readHeader(in);
    return vertexOf(in, header).count > 0;
}

PlyExtent extentOf(std::string_view bytes, const std::string& name, const std::string& up) {
    Reader in(bytes, name);
    const ply::Header header = readHeader(in);
    if (ply::holdsPackedSplats(header)) return ply::extentOf(ply::readPackedSplats(in, header), up);
    const Element& vertex = vertexOf(in, header);
    checkCount(in, vertex, {0, double(kMostPlyPoints)}, "points");
    for (const Element& element : header.elements) {
        if (&element == &vertex) return ply::extentOf(pointsOf(in, vertex, {}), up);
        in.skip(element);
    }
    return {};
}

glm::dvec3 originFor(const PlyExtent& extent, double unit) {
    const double near = std::max(1000.0, 2 * extent.radius * unit); // m
    const glm::dvec3 middle = extent.middle * unit;
    if (glm::all(glm::lessThan(glm::abs(middle), glm::dvec3(near)))) return glm::dvec3(0);
    for (int axis = 0; axis < 3; ++axis)
        if (!limits::kOrigin.holds(middle[axis]))
            throw SceneError(fmt::format("the points are {:.4g} m from zero; allowed: within 10,000 km; if their unit "
                                         "is not the metre, say so: medium.unit = \"mm\", or unit=mm with an upload",
                                         std::abs(middle[axis])));
    return glm::round(middle);
}

PlyFrame frameOf(const Medium& medium, glm::dvec3 origin) { return {origin, double(medium.unit), medium.up}; }

PlyExtent extentOf(const std::filesystem::path& file, const std::string& up) {
    return extentOf(plyBytes(file), file.string(), up);
}

PointCloud parsePly(std::string_view bytes, const std::string& name, const PlyFrame& frame, PlyWanted wanted) {
    Reader in(bytes, name);
    const ply::Header header = readHeader(in);
    const Element& vertex = vertexOf(in, header);
    if (!wanted.may_be_empty || vertex.count > 0)
        checkCount(in, vertex, {limits::kCount.lo, double(std::min(wanted.most, kMostPlyPoints))}, "points");
    const Element* const tetrahedron = wanted.tetrahedra ? in.find(header, "tetrahedron") : nullptr;
    if (tetrahedron)
        checkCount(in, *tetrahedron, limits::kTetrahedra, "rows");
    else if (wanted.tetrahedra)
        in.fail("no element tetrahedron; expected one with \"property list uchar int vertex_indices\"");
    if (tetrahedron && !vertex.has("sigma_t") && !tetrahedron->has("s") && !tetrahedron->has("sigma_t"))
        in.fail("element vertex lacks sigma_t; expected the extinction at each corner of the tetrahedra, 1/m");
    PointCloud cloud;
    cloud.notes = header.unknown;
    const bool packed = ply::holdsPackedSplats(header);
    tellOfOthers(header, tetrahedron != nullptr, packed, cloud.notes);
    if (packed) {
        addPoints(in, ply::readPackedSplats(in, header, wanted.axes), frame, wanted, cloud);
    } else {
        Cells cells;
        bool pending = true; // True: points are still to come
        for (const Element& element : header.elements) {
            if (&element == &vertex)
                addPoints(in, pointsOf(in, element, wanted), frame, wanted, cloud), pending = false;
            else if (&element == tetrahedron)
                cells = readCells(in, element,
                                  {.points = vertex.count, .unit = frame.unit, .extinction = !vertex.has("sigma_t")});
            else
                in.skip(element);
            if (!pending && (!tetrahedron || !cells.corners.empty())) break;
        }
        if (!cells.extinction.empty()) spreadExtinction(cells, cloud);
        if (!cells.ignored.empty())
            cloud.notes.push_back(
                fmt::format("properties of element tetrahedron are ignored: {}",
                            ply::shortened(fmt::format("{}", fmt::join(cells.ignored, ", ")), kLongestNames)));
        cloud.tetrahedra = std::move(cells.corners);
    }
    if (cloud.position.empty() && vertex.count > 0) in.fail("no point is usable; the first, " + cloud.first_dropped);
    if (tetrahedron) dropUnused(cloud);
    for (std::string& note : cloud.notes) note = oneLine(note); // with names of the file
    return cloud;
}

} // namespace brume
