#include "common/camera_keys.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace brume {
namespace {

// A camera that looks straight up or down has no yaw, and lookAt() gives one that nearly does another.
constexpr double kMostPitch = std::numbers::pi / 2 - 0.015;
constexpr double kLeastDistance = 1e-3; // m

double length(const glm::dvec3& v) { return glm::length(v); }
double length(double x) { return std::abs(x); }

// The tangent at a key between two ways of mean velocity `in` and `out`. It favours the slower one, never leads back
// along either, and is 0 where one of them is or where the motion turns back. On a line it is their harmonic mean
// (Fritsch and Butland 1984), for equal steps on a circle the tangent of Catmull and Rom.
template <class T>
T between(const T& in, const T& out) {
    const double a = length(in), b = length(out);
    return a + b > 0 ? (b * in + a * out) / (a + b) : T(0);
}

// The tangent at the other end of a symmetric curve along `way`; 0 where that is.
glm::dvec3 mirrored(const glm::dvec3& tangent, const glm::dvec3& way) {
    const double square = glm::dot(way, way);
    return square > 0 ? 2 * glm::dot(tangent, way) / square * way - tangent : glm::dvec3(0);
}
double mirrored(double tangent, double way) { return way != 0 ? tangent : 0; }

// Part of the way at the part u of the time, for Hermite's cubic from a to b with tangents m and n, over h seconds.
template <class T>
T hermite(const T& a, const T& b, const T& m, const T& n, double h, double u) {
    const double v = u * u, w = v * u;
    return (2 * w - 3 * v + 1) * a + (w - 2 * v + u) * h * m + (3 * v - 2 * w) * b + (w - v) * h * n;
}

// From rest, to rest, or both: the time of the curve, in [0, 1] as `u` is. Where it does not rest its slope is 1.
double eased(double u, bool first, bool last) {
    if (first && last) return u * u * (3 - 2 * u);
    if (first) return u * u * (2 - u);
    if (last) return u + u * u - u * u * u;
    return u;
}

} // namespace

CameraView viewOf(const CameraKey& key) {
    const glm::dvec3 position(key.position), ahead = glm::dvec3(key.target) - position;
    const double distance = std::max(glm::length(ahead), kLeastDistance);
    return {.position = position,
            .yaw = std::atan2(-ahead.x, -ahead.z),
            .pitch = std::clamp(std::asin(std::clamp(ahead.y / distance, -1.0, 1.0)), -kMostPitch, kMostPitch),
            .distance = distance,
            .fov_y = double(key.fov_y)};
}

Pose poseOf(const CameraView& view) {
    const double cy = std::cos(view.yaw / 2), sy = std::sin(view.yaw / 2);
    const double cp = std::cos(view.pitch / 2), sp = std::sin(view.pitch / 2);
    Pose pose;
    pose.position = glm::vec3(view.position);
    pose.orientation = glm::quat(float(cy * cp), float(cy * sp), float(sy * cp), float(-sy * sp));
    pose.fov_y = float(view.fov_y);
    return pose;
}

KeyPath::KeyPath(std::span<const CameraKey> keys) {
    double time = 0, yaw = 0;
    for (const CameraKey& key : keys) {
        const CameraView view = viewOf(key);
        if (!times_.empty()) time += double(key.seconds);
        constexpr double kTurn = 2 * std::numbers::pi;
        yaw = times_.empty() ? view.yaw : view.yaw + kTurn * std::floor((yaw - view.yaw) / kTurn + 0.5);
        times_.push_back(time);
        nodes_.push_back({view.position, {yaw, view.pitch, std::log(view.distance), view.fov_y}});
    }
    for (size_t i = 0; i < nodes_.size(); ++i) tangents_.push_back(tangentAt(i));
    // Beside the ends the curve is symmetric, as on a circle; eased() lets it rest there.
    const size_t last = nodes_.size() - 1;
    const auto end = [&](size_t at, size_t inner) {
        const double h = times_[inner] - times_[at];
        const auto of = [&](const auto& from, const auto& to, const auto& tangent) {
            return last == 1 ? (to - from) / h : mirrored(tangent, to - from);
        };
        Node& t = tangents_[at];
        t.position = of(nodes_[at].position, nodes_[inner].position, tangents_[inner].position);
        for (int i = 0; i < 4; ++i)
            t.angles_and_lens[i] = of(nodes_[at].angles_and_lens[i], nodes_[inner].angles_and_lens[i],
                                      tangents_[inner].angles_and_lens[i]);
    };
    if (last > 0) end(0, 1), end(last, last - 1);
}

KeyPath::Node KeyPath::tangentAt(size_t key) const {
    Node tangent{};
    if (key == 0 || key + 1 == nodes_.size()) return tangent;
    const Node &a = nodes_[key - 1], &b = nodes_[key], &c = nodes_[key + 1];
    const double in = times_[key] - times_[key - 1], out = times_[key + 1] - times_[key];
    tangent.position = between((b.position - a.position) / in, (c.position - b.position) / out);
    for (int i = 0; i < 4; ++i)
        tangent.angles_and_lens[i] = between((b.angles_and_lens[i] - a.angles_and_lens[i]) / in,
                                             (c.angles_and_lens[i] - b.angles_and_lens[i]) / out);
    return tangent;
}

CameraView KeyPath::at(double seconds) const {
    const size_t last = nodes_.size() - 1;
    const auto next = std::upper_bound(times_.begin(), times_.end(), seconds);
    const size_t from = size_t(std::clamp<std::ptrdiff_t>(next - times_.begin() - 1, 0, std::ptrdiff_t(last)));
    const size_t to = std::min(from + 1, last);
    const double h = times_[to] - times_[from];
    const double part = to > from ? std::clamp((seconds - times_[from]) / h, 0.0, 1.0) : 0;
    const double u = eased(part, from == 0, to == last);
    const Node &a = nodes_[from], &b = nodes_[to], &m = tangents_[from], &n = tangents_[to];
    const auto lens = [&](int i) {
        return hermite(a.angles_and_lens[i], b.angles_and_lens[i], m.angles_and_lens[i], n.angles_and_lens[i], h, u);
    };
    return {.position = hermite(a.position, b.position, m.position, n.position, h, u),
            .yaw = lens(0),
            .pitch = lens(1),
            .distance = std::exp(lens(2)),
            .fov_y = lens(3)};
}

} // namespace brume
