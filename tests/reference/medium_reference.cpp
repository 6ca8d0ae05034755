#include "tests/reference/medium_reference.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "tests/reference/gauss_legendre.h"
#include "tests/reference/light_field.h"

namespace brume::reference {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kNodes = 8;
using Rule = GaussLegendre<kNodes>;

// One particle on one ray; t in metres from the camera.
struct Crossing {
    const Blob* blob;
    double from_camera; // m, of the centre
    double closest;     // t of the closest approach
    double across;      // e^(-k^2 b^2)
    double t0, t1;

    double sigma(double t) const {
        const double q = blob->k * (t - closest);
        return blob->sigma_t * across * std::exp(-q * q);
    }
    // Optical depth from t0 to t.
    double depth(double t) const {
        return blob->half_line * across * (std::erf(blob->k * (t - closest)) - std::erf(blob->k * (t0 - closest)));
    }
};

// A piece of a ray on which 8 nodes resolve everything.
struct Panel {
    double t0, t1;
    Rule::Values sigma, light_depth;
    std::array<glm::dvec3, kNodes> scattering; // sum of albedo * sigma

    double middle() const { return (t0 + t1) / 2; }
    double half() const { return (t1 - t0) / 2; }
};

class RayTracer {
public:
    RayTracer(std::span<const Blob> blobs, const LightField& field, Model model, const Settings& settings)
        : blobs_(blobs), field_(field), model_(model), settings_(settings) {
        for (const Blob& b : blobs) largest_k_ = std::max(largest_k_, b.k);
    }

    struct Result {
        glm::dvec3 scattered; // radiance / (irradiance * phase)
        double transmittance;
    };
    Result trace(glm::dvec3 eye, glm::dvec3 w) {
        eye_ = eye;
        w_ = w;
        gather();
        double depth = 0;
        for (const Crossing& c : crossings_) depth += c.depth(c.t1);
        panels_.clear();
        layPanels();
        return {model_ == Model::overlapping ? overlapping() : sequential(), std::exp(-depth)};
    }

private:
    void gather() {
        crossings_.clear();
        for (const Blob& b : blobs_) {
            const double reach = kReach / b.k;
            const glm::dvec3 centre = b.centre - eye_;
            const double closest = glm::dot(centre, w_);
            const glm::dvec3 off = centre - closest * w_;
            const double b2 = glm::dot(off, off);
            if (b2 >= reach * reach) continue;
            const double half = std::sqrt(reach * reach - b2);
            Crossing c{
                &b, glm::length(centre), closest, std::exp(-b.k * b.k * b2), std::max(closest - half, 0.0), closest + half};
            if (model_ == Model::sequential_tetrahedron) cutByTetrahedron(c, centre);
            if (c.t1 > c.t0) crossings_.push_back(c);
        }
    }

    // Vertices at scale * (1,1,1), (1,-1,-1), (-1,1,-1), (-1,-1,1) / sqrt 3: the face opposite to each is at scale / 3.
    void cutByTetrahedron(Crossing& c, glm::dvec3 centre) const {
        const glm::dvec3 vertices[4] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
        for (const glm::dvec3& vertex : vertices) {
            const glm::dvec3 outward = -vertex / std::sqrt(3.0);
            const double away = glm::dot(outward, w_), room = c.blob->scale / 3 + glm::dot(outward, centre);
            if (away > 0)
                c.t1 = std::min(c.t1, room / away);
            else if (away < 0)
                c.t0 = std::max(c.t0, room / away);
            else if (room < 0)
                c.t1 = c.t0; // parallel and outside
        }
    }

    // Covers the union of the crossings with panels, none across the end of a gap.
    void layPanels() {
        by_entry_ = crossings_;
        std::sort(by_entry_.begin(), by_entry_.end(), [](const Crossing& a, const Crossing& b) { return a.t0 < b.t0; });
        for (size_t i = 0; i < by_entry_.size();) {
            const double t0 = by_entry_[i].t0;
            double t1 = by_entry_[i].t1, k = largest_k_ / 2;
            for (; i < by_entry_.size() && by_entry_[i].t0 <= t1; ++i) {
                t1 = std::max(t1, by_entry_[i].t1);
                k = std::max(k, by_entry_[i].blob->k);
            }
            const int count = static_cast<int>(std::ceil((t1 - t0) * k * settings_.refinement / 3.5));
            for (int p = 0; p < count; ++p) addPanel(t0 + (t1 - t0) * p / count, t0 + (t1 - t0) * (p + 1) / count, 12);
        }
    }

    void addPanel(double t0, double t1, int halvings_left) {
        Panel panel{t0, t1, {}, {}, {}};
        for (const Crossing& c : crossings_) {
            // The Gaussian, not its cut: cuts are handled where a particle is integrated, so that panels stay smooth.
            if (std::abs(panel.middle() - c.closest) > panel.half() + kReach / c.blob->k) continue;
            for (int j = 0; j < kNodes; ++j) {
                const double sigma = c.sigma(panel.middle() + panel.half() * rule_.nodes()[j]);
                panel.sigma[j] += sigma;
                panel.scattering[j] += c.blob->albedo * sigma;
            }
        }
        Rule::Values source;
        double depth = 0, largest = 0;
        for (int j = 0; j < kNodes; ++j) {
            const double t = panel.middle() + panel.half() * rule_.nodes()[j];
            panel.light_depth[j] = settings_.shadows ? field_.depth(eye_ + t * w_) : 0;
            source[j] = panel.sigma[j] * std::exp(-panel.light_depth[j]);
            depth += rule_.weights()[j] * panel.half() * panel.sigma[j];
            largest = std::max(largest, source[j]);
        }
        const Rule::Values c = rule_.coefficients(source);
        const double tolerance = 1e-2 / std::pow(settings_.refinement, 6.644); // a hundredth for refinement 2
        const bool resolved = std::abs(c[kNodes - 1]) + std::abs(c[kNodes - 2]) <= tolerance * largest && depth < 2;
        const bool matters = largest * (t1 - t0) > 1e-12;
        if (resolved || !matters || halvings_left == 0) {
            panels_.push_back(panel);
            return;
        }
        addPanel(t0, panel.middle(), halvings_left - 1);
        addPanel(panel.middle(), t1, halvings_left - 1);
    }

    glm::dvec3 overlapping() const {
        glm::dvec3 sum(0);
        double depth = 0; // from the camera to the panel
        for (const Panel& panel : panels_) {
            double through = 0;
            for (int j = 0; j < kNodes; ++j) {
                const double to_node = depth + panel.half() * rule_.upTo(j, panel.sigma);
                sum += rule_.weights()[j] * panel.half() * std::exp(-to_node - panel.light_depth[j]) * panel.scattering[j];
                through += rule_.weights()[j] * panel.half() * panel.sigma[j];
            }
            depth += through;
        }
        return sum;
    }

    glm::dvec3 sequential() {
        std::sort(crossings_.begin(), crossings_.end(),
                  [](const Crossing& a, const Crossing& b) { return a.from_camera < b.from_camera; });
        light_coefficients_.clear();
        for (const Panel& panel : panels_) light_coefficients_.push_back(rule_.coefficients(panel.light_depth));
        glm::dvec3 sum(0);
        double transmittance = 1; // of the particles before this one, from near to far
        for (const Crossing& c : crossings_) {
            sum += transmittance * scatteredBy(c) * c.blob->albedo;
            transmittance *= std::exp(-c.depth(c.t1));
        }
        return sum;
    }

    // One particle by itself, on the parts of the panels that it covers.
    double scatteredBy(const Crossing& c) const {
        double sum = 0;
        for (size_t i = 0; i < panels_.size(); ++i) {
            const Panel& panel = panels_[i];
            const double t0 = std::max(panel.t0, c.t0), t1 = std::min(panel.t1, c.t1);
            if (!(t1 > t0)) continue;
            for (int j = 0; j < kNodes; ++j) {
                const double t = (t0 + t1) / 2 + (t1 - t0) / 2 * rule_.nodes()[j];
                const double light_depth = Rule::evaluate(light_coefficients_[i], (t - panel.middle()) / panel.half());
                sum += rule_.weights()[j] * (t1 - t0) / 2 * c.sigma(t) * std::exp(-c.depth(t) - light_depth);
            }
        }
        return sum;
    }

    std::span<const Blob> blobs_;
    const LightField& field_;
    Model model_;
    Settings settings_;
    Rule rule_;
    double largest_k_ = 0;
    glm::dvec3 eye_{0}, w_{0};
    std::vector<Crossing> crossings_, by_entry_;
    std::vector<Panel> panels_;
    std::vector<Rule::Values> light_coefficients_; // Legendre coefficients of each panel's light depth
};

double phase(const Medium& medium, double cosine) {
    const double g = medium.asymmetry, d = 1 + g * g - 2 * g * cosine;
    return (1 - medium.anisotropy) / (4 * kPi) + medium.anisotropy * (1 - g * g) / (4 * kPi * d * std::sqrt(d));
}

} // namespace

Picture render(const Medium& medium, const Light& light, const Pose& pose, int width, int height, Model model,
               const Settings& settings) {
    const std::vector<Blob> blobs = blobsOf(medium.particles, medium.falloff);
    const glm::dvec3 to_light = glm::normalize(glm::dvec3(light.to_light)), irradiance(light.irradiance), eye(pose.position);
    const LightField field(blobs, to_light);
    const glm::dmat3 world_from_view = glm::mat3_cast(glm::normalize(glm::dquat(pose.orientation)));
    const double tan_y = std::tan(pose.fov_y / 2.0), tan_x = tan_y * width / height;

    Picture picture{width, height, {}, {}};
    picture.radiance.resize(static_cast<size_t>(width) * height);
    picture.transmittance.resize(picture.radiance.size());
    std::atomic<int> next_row{0};
    const auto work = [&] {
        RayTracer tracer(blobs, field, model, settings);
        for (int y = next_row++; y < height; y = next_row++) {
            for (int x = 0; x < width; ++x) {
                const glm::dvec3 in_view(((x + 0.5) / width * 2 - 1) * tan_x, (1 - (y + 0.5) / height * 2) * tan_y, -1);
                const glm::dvec3 w = glm::normalize(world_from_view * in_view);
                const RayTracer::Result result = tracer.trace(eye, w);
                // The photon travels along -to_light, then along -w.
                const size_t pixel = static_cast<size_t>(y) * width + x;
                picture.radiance[pixel] = result.scattered * irradiance * phase(medium, glm::dot(to_light, w));
                picture.transmittance[pixel] = result.transmittance;
            }
        }
    };
    std::vector<std::jthread> threads(settings.threads != 0 ? settings.threads
                                                            : std::max(1u, std::thread::hardware_concurrency()));
    for (std::jthread& thread : threads) thread = std::jthread(work);
    threads.clear();
    return picture;
}

double relativeRmse(std::span<const glm::dvec3> value, std::span<const glm::dvec3> reference) {
    double largest = 0, error = 0, size = 0;
    for (const glm::dvec3& r : reference) largest = std::max({largest, r.x, r.y, r.z});
    for (size_t i = 0; i < reference.size(); ++i) {
        for (int channel = 0; channel < 3; ++channel) {
            const double r = reference[i][channel];
            if (r <= 1e-3 * largest) continue;
            error += (value[i][channel] - r) * (value[i][channel] - r);
            size += r * r;
        }
    }
    return size == 0 ? 0 : std::sqrt(error / size);
}

} // namespace brume::reference
