// Optical depth through the nodes of a volume. Include after lib/extinction_nodes.glsl.

const float kMostNodeStep = 0.5; // nodes between two pairs of samples

// Between two places. Pairs of Gauss and Legendre's points are exact for the cubics that extinction is within a cell.
float depthThroughNodes(vec3 from, vec3 to) {
    const float length = distance(from, to);
    const uint steps = uint(clamp(ceil(length / (kMostNodeStep * push.medium.spacing)), 1, 4096));
    const vec3 step = (to - from) / float(steps);
    float sum = 0;
    for (uint i = 0; i < steps; ++i)
        sum += extinctionAt(from + (float(i) + 0.2113248654) * step) +
               extinctionAt(from + (float(i) + 0.7886751346) * step);
    return sum * 0.5 * length / float(steps);
}
