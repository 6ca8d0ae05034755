#include "common/ply/cells.h"

#include <cmath>

#include <fmt/format.h>

#include "common/scene_limits.h"

namespace brume::ply {
namespace {

// The first of those names that the element has; none: the count of its properties.
size_t firstOf(Reader& in, const Element& element, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names)
        if (const size_t p = in.find(element, name); p < element.properties.size()) return p;
    return element.properties.size();
}

// The number of the property that holds the corners.
size_t cornersOf(Reader& in, const Element& tetrahedron) {
    const size_t at = firstOf(in, tetrahedron, {"vertex_indices", "vertex_index", "indices"});
    if (at == tetrahedron.properties.size() || !tetrahedron.properties[at].list)
        in.fail("element tetrahedron has no corners; expected \"property list uchar int vertex_indices\"");
    if (const Property& p = tetrahedron.properties[at]; isFloat(p.type))
        in.fail(fmt::format("tetrahedron property {} is a list of type {}; expected a whole-number type: \"property "
                            "list uchar int vertex_indices\"",
                            p.name, p.type == Type::f32 ? "float" : "double"));
    return at;
}

} // namespace

Cells readCells(Reader& in, const Element& tetrahedron, CellsWanted wanted) {
    Cells out;
    const size_t none = tetrahedron.properties.size(), corners = cornersOf(in, tetrahedron);
    const size_t own = wanted.extinction ? firstOf(in, tetrahedron, {"s", "sigma_t"}) : none;
    for (size_t p = 0; p < none; ++p)
        if (p != corners && p != own) out.ignored.push_back(tetrahedron.properties[p].name);
    if (own < none) out.extinction_name = tetrahedron.properties[own].name;
    for (uint64_t row = 0; row < tetrahedron.count; ++row) {
        in.beginRow(tetrahedron, row);
        for (size_t p = 0; p < tetrahedron.properties.size(); ++p) {
            const Property& property = tetrahedron.properties[p];
            const uint64_t length = property.list ? in.length(property) : 1;
            if (p != corners) {
                double value = 0;
                for (uint64_t n = length; n > 0; --n) value = in.value(property);
                if (p != own) continue;
                out.extinction.push_back(value / wanted.unit);
                if (!limits::kSigmaT.holds(out.extinction.back()))
                    in.fail(fmt::format("element tetrahedron, {}: {} is {}; allowed: {} to {}", in.rowName(),
                                        out.extinction_name, out.extinction.back(), limits::kSigmaT.lo,
                                        limits::kSigmaT.hi));
                continue;
            }
            if (length != 4)
                in.fail(
                    fmt::format("element tetrahedron, {}: a list of {} vertices; expected 4", in.rowName(), length));
            glm::uvec4& cell = out.corners.emplace_back();
            for (int m = 0; m < 4; ++m) {
                const double index = in.value(property);
                if (!(index >= 0 && index < double(wanted.points)) || index != std::floor(index))
                    in.fail(fmt::format("element tetrahedron, {}: there is no vertex {}; expected 0 to {}",
                                        in.rowName(), index, wanted.points - 1));
                cell[m] = uint32_t(index);
            }
        }
        in.endRow();
    }
    return out;
}

} // namespace brume::ply
