#include "server/render/show.h"

#include <algorithm>

#include "server/encode/picture.h"
#include "server/inputs/constants.h"
#include "server/methods/isv/quadrature.h"
#include "shaders/show_comp.h"

namespace brume {
namespace {

// Pairs of computed pixels and particles, of one picture: about three hundredths of a second on two cores.
constexpr double kMostPairs = 1 << 25, kMostPairsOfGpu = 1u << 31;
constexpr uint32_t kMany = 2048, kFew = 512; // particles: of many, some stand well for all
constexpr uint32_t kMostStep = 4;

// Lanes of a side of a workgroup, times squares of a lane: as in shaders/show.comp.
uint32_t squaresOf(uint32_t show) { return show == gpu::kShowRays ? 16 : 32; }

bool asksParticles(uint32_t show) { return show != gpu::kShowShadow && show != gpu::kShowError; }

// True: the view shows what Gaussians do, not only where they are.
bool isOfGaussians(uint32_t show) { return asksParticles(show) && show != gpu::kShowLight; }

// Mean radius of what is looked for around a particle, over its standard deviation: of spheres, and where a Gaussian
// has ended; of tetrahedra; and of discs.
double reachOf(uint32_t show, bool spheres, double falloff) {
    if (show == gpu::kShowWasted || (show == gpu::kShowOverdraw && !spheres)) return 10 / falloff;
    return show == gpu::kShowLight ? 1.5 / falloff : 5;
}

// How finely a view is computed, so that it holds nobody up.
struct Detail {
    uint32_t step;  // pixels along a side of the squares that one is computed for; in the lattice of rays a ray's cell
    uint32_t every; // one particle in so many is asked
};
Detail detailOf(const ViewGroup& group, const gpu::View& view, bool spheres, double most) {
    const EyeInputs& in = *group.any;
    const gpu::Eye& eye = view.eye;
    const uint32_t least = eye.show == gpu::kShowRays && view.grid.slabs > 0 ? group.rate : 1;
    Detail detail{least, 1};
    if (!asksParticles(eye.show)) return detail;
    const DepthRange range = depthRange(*in.medium->extent, eye.position, -eye.back);
    const double depth = std::max({0.5 * double(range.near + range.far), 0.25 * double(range.far), 0.1});
    const double radius = reachOf(eye.show, spheres, double(in.shared->tick->falloff)) *
                          double(in.medium->extent->deviation) / depth; // at unit view depth
    const double area = 4 * double(eye.tan_x) * double(eye.tan_y), pixel = 2 * double(eye.tan_y) / double(eye.size.y);
    const auto pairs = [&] {
        const double tile = 0.5 * squaresOf(eye.show) * detail.step * pixel;
        const double part = std::min(4 * (radius + tile) * (radius + tile) / area, 1.0); // of the particles, for a tile
        return double(eye.size.x) * eye.size.y / (double(detail.step) * detail.step) * in.medium->count / detail.every *
               part;
    };
    while (in.medium->count / detail.every > kMany && pairs() > most / 4) detail.every *= 2;
    while (pairs() > most) {
        const uint32_t asked = in.medium->count / detail.every;
        if (detail.step < kMostStep * least && eye.show != gpu::kShowParticles && eye.show != gpu::kShowRays)
            detail.step *= 2;
        else if (asked >= kFew)
            detail.every *= 2;
        else
            break;
    }
    return detail;
}

// Methods that draw every particle within its whole support cover pixels with spheres.
bool coversWithSpheres(const std::string& method) { return method == "sphere" || method == "tiles"; }

// True: the legend says that there is nothing to draw. `shadow` still shows its map, which is empty then.
bool hasNothing(LegendOf legend) {
    return legend == LegendOf::no_rays || legend == LegendOf::no_gaussians || legend == LegendOf::no_sun_light;
}

// How particles are drawn that `wasted` and `overdraw` ask for. Other views do not ask.
gpu::Constants drawnAs(const RenderSettings& settings, bool asks) {
    const IsvSettings isv = asks && settings.method == "isv" ? settings.isv : IsvSettings{};
    return {{gpu::kIdFading, isv.fading},
            {gpu::kIdTurned, methods::isv::isTurned(isv)},
            {gpu::kIdDropsNear, methods::isv::dropsNear(isv)},
            {gpu::kIdEarlyReturn, methods::isv::earlyReturnId(isv)}};
}

} // namespace

Show::Show(const gpu::Device& device) : device_(device), program_(device, show_comp, "show") {}

void Show::prepare(std::span<const EyeRequest> eyes, bool full) {
    full_ = full;
    eyes_.clear();
    uint32_t planes = 0, discs = 0;
    any_ = false;
    for (const EyeRequest& eye : eyes) {
        const auto count = uint32_t(std::min<size_t>(eye.errors.size(), gpu::kMostErrorDiscs));
        eyes_.push_back({planes, discs, count});
        planes += uint32_t(PlaneLayout{eye.width, eye.height, full}.bytes() / sizeof(uint32_t));
        discs += count;
        any_ |= eye.show != gpu::kShowPicture;
    }
    if (!any_) return;
    discs_.atLeast(device_, std::max(discs, 1u) * sizeof(gpu::ErrorDisc), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                   gpu::Memory::upload, "measured pixels");
    const std::span<gpu::ErrorDisc> all = discs_.mapped<gpu::ErrorDisc>(discs);
    for (size_t i = 0; i < eyes.size(); ++i)
        std::ranges::copy(eyes[i].errors.last(eyes_[i].discs), all.begin() + eyes_[i].first);
    discs_.flush();
    if (!legends_) makeLegends();
}

void Show::giveBack() { discs_ = {}; }

void Show::makeLegends() {
    std::vector<uint32_t> words;
    placed_.clear();
    for (uint32_t i = 0; i < kLegends; ++i) {
        const LegendPicture picture = drawLegend(legendOf(LegendOf(i)));
        placed_.push_back({uint32_t(words.size()), picture.size});
        words.insert(words.end(), picture.pixels.begin(), picture.pixels.end());
    }
    legends_ = gpu::Buffer(device_, words.size() * sizeof(uint32_t), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                           gpu::Memory::upload, "legends");
    std::ranges::copy(words, legends_.mapped<uint32_t>(words.size()).begin());
    legends_.flush();
}

LegendOf Show::legendFor(const ViewGroup& group, const gpu::View& view, uint32_t discs) const {
    if ((group.any->shared->features.tetrahedra || group.any->shared->features.volume) && isOfGaussians(view.eye.show))
        return LegendOf::no_gaussians;
    const bool sun = group.any->shared->features.sun;
    switch (view.eye.show) {
    case gpu::kShowWasted:
        return LegendOf::wasted;
    case gpu::kShowOverdraw:
        return coversWithSpheres(group.any->shared->settings->method) ? LegendOf::overdraw_spheres
                                                                      : LegendOf::overdraw_tetrahedra;
    case gpu::kShowParticles:
        return LegendOf::particles;
    case gpu::kShowRays:
        return view.grid.slabs > 0 ? LegendOf::rays : LegendOf::no_rays;
    case gpu::kShowDepth:
        return LegendOf::depth;
    case gpu::kShowShadow:
        return sun ? LegendOf::shadow : LegendOf::no_sun_shadow;
    case gpu::kShowLight:
        return sun ? LegendOf::light : LegendOf::no_sun_light;
    default:
        return discs > 0 ? LegendOf::error : LegendOf::no_error;
    }
}

void Show::record(gpu::Commands& commands, const ViewGroup& group) {
    const EyeInputs& in = *group.any;
    if (!any_ || (group.field && in.shared->features.glass)) return; // a layer, no picture
    for (uint32_t i = 0; i < group.count(); ++i) {
        const gpu::View& view = group.views[i];
        if (view.eye.show == gpu::kShowPicture) continue;
        const auto eye = std::ranges::find(eyes_, view.planes, &Eye::planes);
        if (eye == eyes_.end()) throw gpu::Error("a view of no picture");
        const gpu::Commands::Pass pass(commands, "show", uint32_t(eye - eyes_.begin()));
        const VkCommandBuffer cmd = commands.handle();
        const LegendOf legend = legendFor(group, view, eye->discs);
        const Placed& placed = placed_[uint32_t(legend)];
        const uint32_t show = view.eye.show;
        const bool spheres = legend == LegendOf::overdraw_spheres;
        const Detail detail = detailOf(group, view, spheres, device_.isCpu() ? kMostPairs : kMostPairsOfGpu);
        const uint32_t side = squaresOf(show) * detail.step;
        uint32_t items = gpu::groups(in.medium->count, detail.every);
        if (show == gpu::kShowError) items = eye->discs;
        if (hasNothing(legend)) items = 0;
        const gpu::ShowPush push{.items = items,
                                 .every = detail.every,
                                 .step = detail.step,
                                 .spheres = spheres,
                                 .legend = placed.first,
                                 .first_disc = eye->first,
                                 .legend_size = placed.size,
                                 .legend_scale =
                                     std::max(1u, std::min(view.eye.size.y / 360, view.eye.size.x / placed.size.x))};
        gpu::computeToCompute(cmd);
        gpu::Constants own = drawnAs(*in.shared->settings, show == gpu::kShowWasted || show == gpu::kShowOverdraw);
        own.insert(own.end(), {{gpu::kIdShow, show}, {gpu::kIdFull, full_}});
        program_.with(constantsOf(in.shared->features), own)
            .bind(commands, group.resources,
                  {group.blockOf(i), gpu::storageBuffer("Legends", legends_), gpu::storageBuffer("Discs", discs_)},
                  push);
        vkCmdDispatch(cmd, gpu::groups(view.eye.size.x, side), gpu::groups(view.end, side) - view.first / side, 1);
    }
}

} // namespace brume
