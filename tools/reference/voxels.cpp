#include "tools/reference/voxels.h"

#include <algorithm>
#include <cmath>

#include "tools/reference/geometry.h"

namespace brume::reference {

double VoxelPath::at(glm::dvec3 x, glm::ivec3 cell) const {
    const glm::dvec3 t = x - glm::dvec3(cell);
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
        const glm::ivec3 corner(i & 1, i >> 1 & 1, i >> 2);
        const glm::dvec3 part = glm::mix(1.0 - t, t, glm::dvec3(corner));
        sum += part.x * part.y * part.z * double(medium_.volume->at(cell + corner));
    }
    return medium_.times * sum;
}

// Cells from -1 on: the outermost have voxels of nothing on one side.
template <class Act>
void VoxelPath::eachCell(const Ray& ray, const Act& act) const {
    if (!medium_.volume) return;
    const double spacing = medium_.volume->spacing;
    const glm::ivec3 size(medium_.volume->size);
    const glm::dvec3 origin = (ray.origin - medium_.origin) / spacing, step = ray.direction / spacing;
    Interval part{ray.begin, ray.end};
    for (int i = 0; i < 3; ++i) {
        const double lo = -1, hi = size[i];
        if (step[i] == 0) {
            if (!(origin[i] > lo && origin[i] < hi)) return;
            continue;
        }
        const double a = (lo - origin[i]) / step[i], b = (hi - origin[i]) / step[i];
        part = common(part, {std::min(a, b), std::max(a, b)});
    }
    if (part.empty()) return;
    const glm::dvec3 entry = origin + part.begin * step;
    glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(entry)), glm::ivec3(-1), size - 1);
    double t = part.begin;
    while (t < part.end) {
        double leave = part.end;
        int axis = -1;
        for (int i = 0; i < 3; ++i) {
            if (step[i] == 0) continue;
            const double border = (cell[i] + (step[i] > 0 ? 1 : 0) - origin[i]) / step[i];
            if (border < leave) leave = border, axis = i;
        }
        leave = std::max(leave, t);
        bool holds = false;
        for (int i = 0; i < 8 && !holds; ++i)
            holds = medium_.volume->at(cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2)) > 0;
        if (holds && leave > t) act(t, leave, origin, step, cell);
        if (axis < 0) return;
        t = leave;
        cell[axis] += step[axis] > 0 ? 1 : -1;
        if (cell[axis] < -1 || cell[axis] >= size[axis]) return;
    }
}

void VoxelPath::along(const Ray& ray, std::vector<CellPart>& parts) const {
    eachCell(ray, [&](double begin, double end, glm::dvec3 origin, glm::dvec3 step, glm::ivec3 cell) {
        const auto value = [&](double part) { return at(origin + glm::mix(begin, end, part) * step, cell); };
        CellPart one{begin, end, {value(0), value(1)}, {medium_.albedo, medium_.albedo}};
        // What a cubic has beyond the line between its ends: u (1 - u) (bend[0] + bend[1] u).
        const double first = 4.5 * (value(1.0 / 3) - glm::mix(one.extinction[0], one.extinction[1], 1.0 / 3)),
                     second = 4.5 * (value(2.0 / 3) - glm::mix(one.extinction[0], one.extinction[1], 2.0 / 3));
        one.bend[1] = 3 * (second - first);
        one.bend[0] = first - one.bend[1] / 3;
        parts.push_back(one);
    });
}

double VoxelPath::depth(const Ray& ray) const {
    double sum = 0;
    eachCell(ray, [&](double begin, double end, glm::dvec3 origin, glm::dvec3 step, glm::ivec3 cell) {
        const auto value = [&](double part) { return at(origin + glm::mix(begin, end, part) * step, cell); };
        sum += (end - begin) / 6 * (value(0) + 4 * value(0.5) + value(1)); // Simpson's rule is exact for cubics
    });
    return sum;
}

} // namespace brume::reference
