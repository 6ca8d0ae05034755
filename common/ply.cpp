#include "common/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "common/plain_file.h"
#include "common/ply_reader.h"
#include "common/scene.h"
#include "common/scene_limits.h"

namespace brume {

namespace {

using ply::Element, ply::Property, ply::Reader, ply::Type;

constexpr uint64_t kMostPlyBytes = 512ull << 20; // a million points of 64 doubles

// What is taken of a point.
enum Slot : size_t { kX, kY, kZ, kScale, kRadius, kSigmaT, kOpacity, kRed, kGreen, kBlue, kId, kSlots };

struct SlotRule {
    std::string_view name, other; // names of a property; `other` is read where a file has none called `name`
    Limits allowed;
    bool part = false; // True: a part of 1. 255 of a uchar stands for 1, and other whole-number types are refused
};
constexpr std::array<SlotRule, kSlots> kRules{{{"x", "", limits::kPlace},
                                               {"y", "", limits::kPlace},
                                               {"z", "", limits::kPlace},
                                               {"scale", "", limits::kScale},
                                               {"radius", "", limits::kScale},
                                               {"sigma_t", "", limits::kSigmaT},
                                               {"opacity", "", limits::kColour, true},
                                               {"red", "diffuse_red", limits::kColour, true},
                                               {"green", "diffuse_green", limits::kColour, true},
                                               {"blue", "diffuse_blue", limits::kColour, true},
                                               {"id", "", {-2147483648.0, 4294967295.0}}}};

using Point = std::array<double, kSlots>;

struct Columns {
    std::vector<size_t> slot_of; // per property; kSlots: not taken
    std::array<bool, kSlots> there{};
    Point unit{}; // factors: a slot's value is the file's number times its factor
};

// The number of the element's property of that name; none: properties.size().
size_t find(Reader& in, const Element& element, std::string_view name) {
    size_t found = element.properties.size();
    for (size_t p = 0; p < element.properties.size(); ++p) {
        if (name.empty() || element.properties[p].name != name) continue;
        if (found < element.properties.size())
            in.fail(fmt::format("{} property {} is there twice", element.name, name));
        found = p;
    }
    return found;
}

bool isFloat(const Property& p) { return p.type == Type::f32 || p.type == Type::f64; }

void take(Reader& in, const Element& vertex, Slot slot, Columns& out) {
    const SlotRule& rule = kRules[slot];
    size_t at = find(in, vertex, rule.name);
    if (at == vertex.properties.size()) at = find(in, vertex, rule.other);
    if (at == vertex.properties.size()) return;
    const Property& p = vertex.properties[at];
    if (p.list) in.fail("vertex property " + p.name + " is a list; expected one number");
    if (rule.part && !isFloat(p) && p.type != Type::u8)
        in.fail("vertex property " + p.name + " has an odd type; expected uchar (0 to 255) or float (0 to 1)");
    out.slot_of[at] = slot;
    out.there[slot] = true;
    out.unit[slot] = rule.part && !isFloat(p) ? 1.0 / 255 : 1.0;
}

Columns columnsOf(Reader& in, const Element& vertex, PlyWanted wanted) {
    Columns out{.slot_of = std::vector<size_t>(vertex.properties.size(), kSlots)};
    for (const Slot slot : {kX, kY, kZ, kSigmaT, kRed, kGreen, kBlue}) take(in, vertex, slot, out);
    if (!wanted.tetrahedra) take(in, vertex, kScale, out);
    if (!wanted.tetrahedra && !out.there[kScale]) take(in, vertex, kRadius, out);
    if (!wanted.tetrahedra && !out.there[kSigmaT]) take(in, vertex, kOpacity, out);
    if (const size_t id = find(in, vertex, "id");
        wanted.ids && id < vertex.properties.size() && !vertex.properties[id].list && !isFloat(vertex.properties[id]))
        take(in, vertex, kId, out);
    if (!out.there[kX] || !out.there[kY] || !out.there[kZ]) in.fail("element vertex lacks one of x, y, z");
    if (out.there[kRed] != out.there[kGreen] || out.there[kRed] != out.there[kBlue])
        in.fail("element vertex has some of red, green, blue; expected all or none");
    if (wanted.tetrahedra && !out.there[kSigmaT])
        in.fail("element vertex lacks sigma_t; expected the extinction at each corner of the tetrahedra, 1/m");
    return out;
}

// Empty if the point can be used; otherwise which of its numbers is out of range.
std::string problemOf(const Point& point, const Columns& columns, glm::dvec3 origin) {
    for (size_t s = 0; s < kSlots; ++s) {
        if (!columns.there[s] || (kRules[s].allowed.holds(point[s]) && (s != kId || point[s] == std::floor(point[s]))))
            continue;
        if (s > kZ)
            return fmt::format("{} is {}; allowed: {} to {}{}", kRules[s].name, point[s], kRules[s].allowed.lo,
                               kRules[s].allowed.hi,
                               kRules[s].part ? " as float, 0 to 255 as uchar"
                               : s == kId     ? ", whole numbers"
                                              : "");
        return fmt::format(
            "{} is {}; allowed: finite, within 50 km of the scene's origin (origin = [x, y, z] at its top)",
            kRules[s].name, point[s] + origin[static_cast<int>(s)]);
    }
    return {};
}

void readPoints(Reader& in, const Element& vertex, glm::dvec3 origin, PlyWanted wanted, PointCloud& out) {
    const Columns columns = columnsOf(in, vertex, wanted);
    for (size_t p = 0; p < vertex.properties.size(); ++p)
        if (columns.slot_of[p] == kSlots) out.ignored.push_back(vertex.properties[p].name);
    for (uint64_t row = 0; row < vertex.count; ++row) {
        std::array<double, kSlots + 1> v{}; // the last takes what is not wanted
        in.beginRow(vertex, row);
        for (size_t p = 0; p < vertex.properties.size(); ++p) {
            const Property& property = vertex.properties[p];
            for (uint64_t n = property.list ? in.length(property) : 1; n > 0; --n)
                v[columns.slot_of[p]] = in.value(property);
        }
        in.endRow();
        Point taken;
        for (size_t s = 0; s < kSlots; ++s) taken[s] = v[s] * columns.unit[s];
        for (int axis = 0; axis < 3; ++axis) taken[kX + static_cast<size_t>(axis)] -= origin[axis];
        if (const std::string problem = problemOf(taken, columns, origin); !problem.empty()) {
            if (wanted.tetrahedra)
                in.fail("a corner of tetrahedra cannot be left out: " + in.rowName() + ": " + problem);
            if (out.dropped++ == 0) out.first_dropped = in.rowName() + ": " + problem;
            continue;
        }
        const auto add = [&](std::vector<float>& to, Slot slot) {
            if (columns.there[slot]) to.push_back(static_cast<float>(taken[slot]));
        };
        out.position.emplace_back(taken[kX], taken[kY], taken[kZ]);
        add(out.scale, kScale);
        add(out.radius, kRadius);
        add(out.sigma_t, kSigmaT);
        add(out.opacity, kOpacity);
        if (columns.there[kId]) out.id.push_back(static_cast<int64_t>(taken[kId]));
        if (columns.there[kRed]) out.albedo.emplace_back(taken[kRed], taken[kGreen], taken[kBlue]);
    }
}

// The number of the property that holds the corners.
size_t cornersOf(Reader& in, const Element& tetrahedron) {
    size_t at = find(in, tetrahedron, "vertex_indices");
    if (at == tetrahedron.properties.size()) at = find(in, tetrahedron, "vertex_index");
    if (at == tetrahedron.properties.size() || !tetrahedron.properties[at].list)
        in.fail("element tetrahedron has no corners; expected \"property list uchar int vertex_indices\"");
    if (const Property& p = tetrahedron.properties[at]; isFloat(p))
        in.fail(fmt::format("tetrahedron property {} is a list of type {}; expected a whole-number type: \"property "
                            "list uchar int vertex_indices\"",
                            p.name, p.type == Type::f32 ? "float" : "double"));
    return at;
}

void readTetrahedra(Reader& in, const Element& tetrahedron, uint64_t points, std::vector<glm::uvec4>& out) {
    const size_t corners = cornersOf(in, tetrahedron);
    for (uint64_t row = 0; row < tetrahedron.count; ++row) {
        in.beginRow(tetrahedron, row);
        for (size_t p = 0; p < tetrahedron.properties.size(); ++p) {
            const Property& property = tetrahedron.properties[p];
            const uint64_t length = property.list ? in.length(property) : 1;
            if (p != corners) {
                for (uint64_t n = length; n > 0; --n) in.value(property);
                continue;
            }
            if (length != 4)
                in.fail(
                    fmt::format("element tetrahedron, {}: a list of {} vertices; expected 4", in.rowName(), length));
            glm::uvec4& cell = out.emplace_back();
            for (int m = 0; m < 4; ++m) {
                const double index = in.value(property);
                if (!(index >= 0 && index < double(points)) || index != std::floor(index))
                    in.fail(fmt::format("element tetrahedron, {}: there is no vertex {}; expected 0 to {}",
                                        in.rowName(), index, points - 1));
                cell[m] = uint32_t(index);
            }
        }
        in.endRow();
    }
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

// The first element of that name; null: there is none.
const Element* named(const ply::Header& header, std::string_view name) {
    for (const Element& element : header.elements)
        if (element.name == name) return &element;
    return nullptr;
}

std::string readBytes(const std::filesystem::path& file) {
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

} // namespace

PointCloud loadPly(const std::filesystem::path& file, glm::dvec3 origin, PlyWanted wanted) {
    return parsePly(readBytes(file), file.string(), origin, wanted);
}

bool holdsTetrahedra(std::string_view bytes, const std::string& name) {
    Reader in(bytes, name);
    const ply::Header header = readHeader(in);
    const Element* const tetrahedron = named(header, "tetrahedron");
    return tetrahedron && tetrahedron->count > 0;
}

PointCloud parsePly(std::string_view bytes, const std::string& name, glm::dvec3 origin, PlyWanted wanted) {
    Reader in(bytes, name);
    const ply::Header header = readHeader(in);
    const Element* const vertex = named(header, "vertex");
    if (!vertex) in.fail("no element vertex; expected one with x, y, z");
    checkCount(in, *vertex, limits::kCount, "points");
    const Element* const tetrahedron = wanted.tetrahedra ? named(header, "tetrahedron") : nullptr;
    if (tetrahedron)
        checkCount(in, *tetrahedron, limits::kTetrahedra, "rows");
    else if (wanted.tetrahedra)
        in.fail("no element tetrahedron; expected one with \"property list uchar int vertex_indices\"");
    PointCloud cloud;
    for (const Element& element : header.elements) {
        if (&element == vertex)
            readPoints(in, element, origin, wanted, cloud);
        else if (&element == tetrahedron)
            readTetrahedra(in, element, vertex->count, cloud.tetrahedra);
        else
            in.skip(element);
        if (&element == vertex && cloud.position.empty())
            in.fail("no point is usable; the first, " + cloud.first_dropped);
        if (!cloud.position.empty() && (!tetrahedron || !cloud.tetrahedra.empty())) break;
    }
    if (tetrahedron) dropUnused(cloud);
    return cloud;
}

} // namespace brume
