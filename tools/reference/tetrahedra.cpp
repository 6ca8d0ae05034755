#include "tools/reference/tetrahedra.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "tools/reference/geometry.h"

namespace brume::reference {
namespace {

// A corner as the ray sees it: to the right, upward and forward from the ray's origin, in m.
struct Seen {
    double x, y, forward;
};

class View {
public:
    explicit View(const Ray& ray) : origin_(ray.origin), forward_(ray.direction) {
        const glm::dvec3 size = glm::abs(forward_);
        const glm::dvec3 other = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                                 : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                      : glm::dvec3(0, 0, 1);
        right_ = glm::normalize(glm::cross(other, forward_));
        up_ = glm::cross(forward_, right_);
    }
    Seen see(glm::dvec3 place) const {
        const glm::dvec3 to = place - origin_;
        return {glm::dot(to, right_), glm::dot(to, up_), glm::dot(to, forward_)};
    }

private:
    glm::dvec3 origin_, forward_, right_, up_;
};

// On which side of the edge from a to b the ray passes.
struct Side {
    double area; // of the parallelogram of both as seen: rounded once, and of the other sign for the edge from b to a
    bool left;   // True: the ray passes on the left
};
Side sideOf(const Seen& a, const Seen& b) {
    const double p = a.x * b.y, q = a.y * b.x;
    double area = p - q;
    if (std::abs(area) < 1e-4 * (std::abs(p) + std::abs(q))) area += std::fma(a.x, b.y, -p) - std::fma(a.y, b.x, -q);
    // A ray through the edge counts as moved: right by less than any number, and up by less than any part of that.
    return {area, area != 0 ? area > 0 : a.y != b.y ? a.y > b.y : b.x > a.x};
}

// Where the ray goes through a face, and how much each corner has to say there.
struct FaceHit {
    double t;
    std::array<const TetrahedralMedium::Corner*, 3> corners;
    std::array<double, 3> parts;

    double extinction() const {
        return parts[0] * corners[0]->sigma_t + parts[1] * corners[1]->sigma_t + parts[2] * corners[2]->sigma_t;
    }
    glm::dvec3 albedo() const {
        return parts[0] * corners[0]->albedo + parts[1] * corners[1]->albedo + parts[2] * corners[2]->albedo;
    }
};

// The two faces of a tetrahedron that the ray's line goes through, the nearer first. Sides are exact for the corners as
// seen, so there are two or none, and tetrahedra that share a face agree on it. False: none.
bool cross(const TetrahedralMedium& medium, const glm::uvec4& cell, const View& view, std::array<FaceHit, 2>& hits) {
    constexpr int kFaces[4][3]{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
    std::array<Seen, 4> seen;
    for (int i = 0; i < 4; ++i) seen[size_t(i)] = view.see(medium.corners[cell[i]].place);
    Side sides[4][4];
    for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j) sides[i][j] = sideOf(seen[size_t(i)], seen[size_t(j)]);
    size_t count = 0;
    for (const auto& [a, b, c] : kFaces) {
        const Side &ab = sides[a][b], &bc = sides[b][c], &ac = sides[a][c];
        if (ab.left != bc.left || ab.left == ac.left || count == 2) continue;
        FaceHit& hit = hits[count++];
        const double areas[3]{std::abs(bc.area), std::abs(ac.area), std::abs(ab.area)};
        const double sum = areas[0] + areas[1] + areas[2];
        hit.parts = {areas[0] / sum, areas[1] / sum, areas[2] / sum};
        hit.corners = {&medium.corners[cell[a]], &medium.corners[cell[b]], &medium.corners[cell[c]]};
        hit.t = hit.parts[0] * seen[size_t(a)].forward + hit.parts[1] * seen[size_t(b)].forward +
                hit.parts[2] * seen[size_t(c)].forward;
    }
    if (count == 2 && hits[1].t < hits[0].t) std::swap(hits[0], hits[1]);
    return count == 2;
}

// Calls act(where the ray enters, where it leaves, the part of that on the ray) for every tetrahedron on it, in any
// order.
template <class Act>
void eachCrossed(const TetrahedralMedium& medium, std::span<const BoundingNode> nodes, const Ray& ray, const Act& act) {
    const View view(ray);
    std::array<FaceHit, 2> hits;
    walk(
        nodes, [&](const Bounds3& bounds) { return passes(bounds, ray); },
        [&](uint32_t i) {
            if (!cross(medium, medium.cells[i], view, hits)) return false;
            const Interval part = common({hits[0].t, hits[1].t}, {ray.begin, ray.end});
            if (!part.empty()) act(hits[0], hits[1], part);
            return false;
        });
}

// Bounds of corners, with room for roundings.
template <size_t n>
Bounds3 boundsOf(const TetrahedralMedium& medium, const std::array<uint32_t, n>& corners) {
    Bounds3 bounds;
    for (const uint32_t corner : corners) bounds.add({medium.corners[corner].place, medium.corners[corner].place});
    const glm::dvec3 room = 1e-9 * (glm::max(glm::abs(bounds.lo), glm::abs(bounds.hi)) + 1.0);
    return {bounds.lo - room, bounds.hi + room};
}

} // namespace

double CellPart::extinctionAt(double t) const {
    const double u = (t - begin) / (end - begin);
    return glm::mix(extinction[0], extinction[1], u) + u * (1 - u) * (bend[0] + bend[1] * u);
}

glm::dvec3 CellPart::albedoAt(double t) const { return glm::mix(albedo[0], albedo[1], (t - begin) / (end - begin)); }

double CellPart::depthTo(double t) const {
    if (t <= begin) return 0;
    const double u = t >= end ? 1 : (t - begin) / (end - begin);
    const double straight = u * (extinction[0] + u * (extinction[1] - extinction[0]) / 2);
    const double bent = u * u * (bend[0] * (0.5 - u / 3) + bend[1] * u * (1.0 / 3 - u / 4));
    return (end - begin) * (straight + bent);
}

double CellPart::whereDepthIs(double depth) const {
    if (!(depth < depthTo(end))) return kInfinity;
    const double slope = (extinction[1] - extinction[0]) / (end - begin);
    const double there = std::sqrt(std::max(extinction[0] * extinction[0] + 2 * slope * depth, 0.0)); // extinction
    return std::min(begin + 2 * depth / (extinction[0] + there), end);
}

CellPart CellPart::cut(Interval to) const {
    CellPart part = *this;
    if (to.begin > begin)
        part.begin = to.begin, part.extinction[0] = extinctionAt(to.begin), part.albedo[0] = albedoAt(to.begin);
    if (to.end < end) part.end = to.end, part.extinction[1] = extinctionAt(to.end), part.albedo[1] = albedoAt(to.end);
    return part;
}

TetrahedraTree::TetrahedraTree(const TetrahedralMedium& medium) : medium_(medium), edges_(outside()) {
    std::vector<Bounds3> bounds;
    for (const glm::uvec4& c : medium.cells) bounds.push_back(boundsOf<4>(medium, {c[0], c[1], c[2], c[3]}));
    nodes_ = boundingTree(bounds);
    bounds.clear();
    for (const Edge& edge : edges_) bounds.push_back(boundsOf(medium, edge));
    edge_nodes_ = boundingTree(bounds);
}

std::vector<TetrahedraTree::Edge> TetrahedraTree::outside() const {
    std::vector<std::array<uint32_t, 3>> faces;
    for (const glm::uvec4& cell : medium_.cells) {
        std::array<uint32_t, 4> c{cell[0], cell[1], cell[2], cell[3]};
        std::ranges::sort(c);
        faces.insert(faces.end(), {{c[0], c[1], c[2]}, {c[0], c[1], c[3]}, {c[0], c[2], c[3]}, {c[1], c[2], c[3]}});
    }
    std::ranges::sort(faces);
    std::vector<Edge> edges;
    for (size_t i = 0; i < faces.size(); ++i) {
        const auto& f = faces[i];
        const bool inside = (i > 0 && faces[i - 1] == f) || (i + 1 < faces.size() && faces[i + 1] == f);
        if (inside) continue;
        edges.insert(edges.end(), {{f[0], f[1]}, {f[0], f[2]}, {f[1], f[2]}});
    }
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

void TetrahedraTree::along(const Ray& ray, std::vector<CellPart>& parts) const {
    parts.clear();
    eachCrossed(medium_, nodes_, ray, [&](const FaceHit& in, const FaceHit& out, Interval part) {
        const CellPart whole{in.t, out.t, {in.extinction(), out.extinction()}, {in.albedo(), out.albedo()}};
        parts.push_back(whole.cut(part));
    });
    std::ranges::sort(parts, {}, &CellPart::begin);
}

double TetrahedraTree::depth(const Ray& ray) const {
    double sum = 0;
    eachCrossed(medium_, nodes_, ray, [&](const FaceHit& in, const FaceHit& out, Interval part) {
        const CellPart whole{in.t, out.t, {in.extinction(), out.extinction()}};
        sum += whole.depthTo(part.end) - whole.depthTo(part.begin);
    });
    return sum;
}

void TetrahedraTree::shadowEdges(const LightSource& light, const Ray& ray, std::vector<double>& t) const {
    const bool distant = light.kind == LightSource::Kind::directional;
    // An edge in line with the light and a point of the ray meets the plane of the ray and the light.
    const glm::dvec3 toward = distant ? light.to_light : light.position - ray.origin;
    const glm::dvec3 normal = glm::cross(ray.direction, toward);
    if (!(glm::length(normal) > 1e-12 * glm::length(toward))) return; // the light is on the ray's line: no edge is
    walk(
        edge_nodes_, [&](const Bounds3& bounds) { return meetsPlane(bounds, normal, ray.origin); },
        [&](uint32_t i) {
            const glm::dvec3 a = medium_.corners[edges_[i][0]].place - ray.origin,
                             b = medium_.corners[edges_[i][1]].place - ray.origin;
            const double from = glm::dot(normal, a), to = glm::dot(normal, b);
            if (from == to || from * to > 0) return false;
            const glm::dvec3 met = a + from / (from - to) * (b - a);
            const glm::dvec3 on = distant ? toward : toward - met; // from there to the light
            const double slope = glm::dot(glm::cross(ray.direction, on), normal);
            // met = t * direction + s * on, where the edge is between the ray and the light if s is positive.
            if (glm::dot(glm::cross(ray.direction, met), normal) * slope >= 0 && slope != 0)
                t.push_back(glm::dot(glm::cross(met, on), normal) / slope);
            return false;
        });
}

} // namespace brume::reference
