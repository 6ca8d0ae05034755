#include "server/methods/rays/slab_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "server/gpu/binding_sizes.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/local_light_block.h"
#include "server/medium/band_limit.h"
#include "server/methods/rays/ray_plan.h"
#include "shaders/ray_ends_comp.h"
#include "shaders/slab_spline_comp.h"

namespace brume {
namespace {

constexpr float kFogLength = 1; // m, of slabs before the eye where there are no particles
constexpr double kFogFar = 1e7; // m, view depth behind which fog is one piece
// Standard deviations of the medium in which the light that it lets through to fog is taken as linear.
constexpr float kFogStep = 1;
constexpr uint32_t kJpegBlock = 8;    // pixels along a side
constexpr float kMostDepthRatio = 64; // of the depths that bytes of layers stand for

void coarsen(gpu::SlabGrid& grid) {
    grid.thickness *= 2;
    grid.lines.z = gpu::groups(grid.lines.z, 2);
    grid.slabs = grid.lines.z * grid.sheet;
}

// View depths between which the medium lies before the eye.
DepthRange depths(const EyeInputs& in) {
    if (in.medium->count == 0) return {kNearDepth, kNearDepth + kFogLength}; // only fog, if that
    const DepthRange all = depthRange(*in.medium->extent, in.pose.position, in.pose.orientation * glm::vec3(0, 0, -1));
    return {std::max(all.near, kNearDepth), all.far};
}

float pixelOf(const EyeInputs& in) {
    return 2 * in.block->eye.tan_y / float(in.size.height);
} // m per m of view depth, rad

// The medium's standard deviation in pixels, in the middle of the depths where it is.
float deviationInPixels(const EyeInputs& in, float near, float far) {
    return in.medium->extent->deviation / (pixelOf(in) * 0.5f * (near + far));
}

// How many slabs before or behind the particles make `length` m, each a fifth thicker than the one before it, where
// the first is no thicker than `thickness`; and the unit of their thickness (shaders/lib/slab_depth.glsl).
struct Grown {
    uint32_t slabs = 0;
    float unit = 1;
};
Grown grown(double length, double thickness) {
    if (!(length > 0)) return {};
    const double growth = std::exp2(double(gpu::kLogFogGrowth)), unit = thickness / (growth - 1);
    const double slabs = std::max(std::ceil(std::log2(1 + length / unit) / double(gpu::kLogFogGrowth)), 1.0);
    return {uint32_t(slabs), float(length / (std::pow(growth, slabs) - 1))};
}

// Slabs of fog, around those of the particles.
void addFogSlabs(gpu::SlabGrid& grid, const EyeInputs& in) {
    const double end = double(grid.depth) + double(grid.thickness) * grid.slabs;
    const bool slabs = in.shared->needs_rays || in.shared->features.opaque;
    const double first = slabs ? double(grid.thickness) : kFogFar;
    const Grown front = grown(double(grid.depth) - double(kNearDepth), first), back = grown(kFogFar - end, first);
    grid.front = front.slabs, grid.front_unit = front.unit;
    grid.back = back.slabs, grid.back_unit = back.unit;
    grid.fog_step = kFogStep * in.medium->extent->deviation;
}

// RenderSettings::lamp_spacing; 0 where rays hold no lamp's light. Shaders round otherwise, so a lamp that is on the
// edge counts.
float lampSpacing(const EyeInputs& in, const gpu::SlabGrid& grid) {
    constexpr float kPerhaps = 1.001f;
    const float spacing = in.shared->settings->lamp_spacing;
    const bool any = std::ranges::any_of(in.shared->lights, [&](const gpu::LocalLight& light) {
        return isHeldByRays(light, in.block->eye, grid, kPerhaps * spacing);
    });
    return any ? spacing : 0;
}

// The grid of the whole picture, but for its rows. `sheet`: slabs that are filled together.
gpu::SlabGrid gridOf(const EyeInputs& in, uint32_t sheet) {
    gpu::SlabGrid grid{};
    auto [near, far] = depths(in);
    far = std::max(far, near + 1e-3f); // all of it behind the eye: slabs without particles
    const float deviation = in.medium->extent->deviation, projected = deviationInPixels(in, near, far);
    grid.rate = in.rate;
    if (grid.rate == 0)
        for (auto rate = std::rbegin(kRates); rate != std::rend(kRates); ++rate)
            if (grid.rate = *rate; float(*rate) <= kRaysPerDeviation * projected) break;
    // A row of tiles has bits for all particles.
    const VkDeviceSize bits = in.medium->count / 8; // bytes, of a tile
    while (grid.rate < std::end(kRates)[-1] &&
           gpu::groups(in.size.width, grid.rate * gpu::kSlabTile) * bits > gpu::kLargestBinding)
        grid.rate *= 2;
    const float wanted = std::ceil((far - near) / (kSlabsPerDeviation * deviation));
    const uint32_t asked = in.shared->settings->slabs;
    const uint32_t slabs = asked ? asked : uint32_t(std::clamp(wanted, 1.0f, float(kMostSlabs)));
    grid.sheet = sheet;
    grid.margin = grid.rate > 1 ? kRayMargin : 1;
    grid.nodes = {gpu::groups(in.size.width, grid.rate) + raysBeyond(grid.margin), 0};
    grid.lines = {gpu::groups(grid.nodes.x, gpu::kSlabTile), 0,
                  gpu::groups(std::max(slabs, kLeastSlabs), kLeastSlabs) * (kLeastSlabs / sheet)};
    grid.slabs = grid.lines.z * grid.sheet;
    grid.depth = near;
    grid.thickness = (far - near) / float(grid.slabs);
    if (in.shared->features.casters) grid.caster_words = gpu::groups(in.shared->bodies, gpu::kWordCasters);
    grid.albedo = in.medium->extent->albedo;
    grid.lamp_spacing = lampSpacing(in, grid);
    grid.soft_edges = in.shared->settings->soft_edges ? 1 : 0;
    if (in.shared->features.fog) addFogSlabs(grid, in);
    return grid;
}

} // namespace

SlabRays::SlabRays(const MethodContext& context)
    : device_(context.device), features_(context.features), ends_(device_, ray_ends_comp, "ray_ends"),
      spline_(device_, slab_spline_comp, "slab_spline") {}

std::span<const ViewGroup> SlabRays::prepare(std::span<const EyeInputs> eyes) {
    group(eyes);
    grow(field_, most_.field * sizeof(float), "slab field");
    grow(layered_, most_.layered * sizeof(float), "layers with depth");
    growOwn(most_);
    views_buffer_.atLeast(device_, views_.size() * sizeof(gpu::View), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                          gpu::Memory::upload, "views");
    std::copy(views_.begin(), views_.end(), views_buffer_.mapped<gpu::View>(views_.size()).begin());
    views_buffer_.flush();
    for (ViewGroup& group : groups_) {
        group.field = &field_;
        group.block = gpu::storageBuffer("Views", views_buffer_,
                                         VkDeviceSize(group.views.data() - views_.data()) * sizeof(gpu::View),
                                         group.views.size_bytes());
        group.resources = gpu::Resources(&group.any->resources);
        group.resources.give(group.block);
        group.resources.give(gpu::storageBuffer("Field", field_));
        group.resources.give(gpu::storageBuffer("Layered", layered_));
    }
    return groups_;
}

// Pixels between those that are shaded.
uint32_t SlabRays::shadingStepOf(const EyeInputs& in, uint32_t rate) const {
    if (in.shared->uses_target) return 1;
    const auto [near, far] = depths(in);
    if (features_.fog) return 1; // its edges are sharp
    const float lobe = features_.lobe ? in.shared->lobe_width / pixelOf(in) : std::numeric_limits<float>::infinity();
    return shadingStep(*in.shared->settings, rate, deviationInPixels(in, near, std::max(near, far)), lobe);
}

// Makes views_, and groups_ of them. Alone in a group is each view of one eye in several bands, and every view that
// passes through the common target.
void SlabRays::group(std::span<const EyeInputs> eyes) {
    order_.clear();
    for (const EyeInputs& in : eyes) order_.push_back(&in);
    const auto kind = [&](const EyeInputs* in) {
        const uint32_t rate = gridOf(*in, device_.lanesTogether()).rate;
        return std::tuple(in->medium, coloursOf(*in), rate, shadingStepOf(*in, rate), in->depth_layers);
    };
    const bool alone = eyes.front().shared->uses_target;
    if (!alone)
        std::sort(order_.begin(), order_.end(), [&](const EyeInputs* a, const EyeInputs* b) {
            return std::tuple(kind(a), a->view) < std::tuple(kind(b), b->view);
        });
    views_.clear();
    groups_.clear();
    firsts_.clear();
    most_ = {};
    Elements elements;
    bool open = false; // True: the last group takes more views
    for (const EyeInputs* in : order_) {
        const Bands bands = bandsOf(*in);
        const uint32_t step = shadingStepOf(*in, bands.grid.rate);
        const gpu::FieldColours colours = coloursOf(*in);
        const bool whole = bands.step >= bands.cells && !alone;
        for (uint32_t row = 0; row < bands.cells; row += bands.step) {
            Elements with = elements;
            gpu::View view = viewOf(*in, bands, row, step, with);
            const auto fits = [&](const ViewGroup& last) {
                return last.any->medium == in->medium && last.rate == bands.grid.rate && last.colours == colours &&
                       last.step == step && last.depth_layers == (view.layers.count > 0) &&
                       bytesOfLargest(with) <= gpu::kLargestBinding;
            };
            if (!(open && whole && fits(groups_.back()))) {
                with = {};
                view = viewOf(*in, bands, row, step, with);
                groups_.push_back({.any = in,
                                   .rate = bands.grid.rate,
                                   .colours = colours,
                                   .step = step,
                                   .depth_layers = view.layers.count > 0});
                firsts_.push_back(views_.size());
            }
            groups_.back().bins = with.bins;
            open = whole;
            elements = with;
            views_.push_back(view);
            most_ = {std::max(most_.members, elements.members), std::max(most_.bins, elements.bins),
                     std::max(most_.added, elements.added),     std::max(most_.field, elements.field),
                     std::max(most_.shaded, elements.shaded),   std::max(most_.layered, elements.layered)};
        }
    }
    firsts_.push_back(views_.size());
    for (size_t g = 0; g < groups_.size(); ++g)
        groups_[g].views = std::span(views_).subspan(firsts_[g], firsts_[g + 1] - firsts_[g]);
}

VkDeviceSize SlabRays::bytesOfLargest(const Elements& elements) {
    return std::max({elements.members * sizeof(gpu::SlabMember), elements.bins * sizeof(uint32_t),
                     elements.added * sizeof(glm::vec4), elements.field * sizeof(float),
                     elements.shaded * sizeof(uint32_t), elements.layered * sizeof(float)});
}

gpu::View SlabRays::viewOf(const EyeInputs& in, const Bands& bands, uint32_t first_row, uint32_t step,
                           Elements& elements) const {
    gpu::View view = *in.block;
    view.grid = bands.grid;
    view.grid.first_row = first_row;
    view.first = first_row * bands.grid.rate;
    view.end = std::min(view.first + bands.step * bands.grid.rate, in.size.height);
    view.members = uint32_t(elements.members);
    view.bins = uint32_t(elements.bins);
    view.added = uint32_t(elements.added);
    view.field = uint32_t(elements.field);
    view.shaded = uint32_t(elements.shaded);
    addLayers(in, bands, view, elements);
    const Elements own = elementsOf(in, view.grid);
    elements.members += own.members;
    elements.bins += own.bins;
    elements.added += own.added;
    elements.field += fieldWords(in, view.grid);
    elements.shaded += shadedWords(view, step);
    return view;
}

// The lattice of a view's layers with depth: rays of the picture's grid. All bands have the same.
void SlabRays::addLayers(const EyeInputs& in, const Bands& bands, gpu::View& view, Elements& elements) const {
    gpu::DepthLayers& layers = view.layers;
    const gpu::SlabGrid& grid = view.grid;
    layers.count = in.shared->needs_rays && !features_.glass ? in.depth_layers : 0;
    if (layers.count == 0) return;
    layers.every = gpu::groups(gpu::kLeastLayerSpacing, grid.rate);
    layers.first = grid.margin % layers.every;
    const glm::uvec2 rays = glm::uvec2(grid.nodes.x, bands.cells + raysBeyond(grid.margin));
    layers.nodes = (rays - layers.first - 1u) / layers.every + 1u;
    layers.rows = gpu::groups(layers.nodes.y, kJpegBlock) * kJpegBlock;
    layers.blocks = layers.count + (features_.opaque ? 0 : 1);
    layers.data = layers.colours + 3 * layers.blocks * layers.rows * gpu::layerWords(layers.nodes.x);
    layers.near = std::max(grid.depth, (grid.depth + grid.thickness * float(grid.slabs)) / kMostDepthRatio);
    layers.far = grid.depth + grid.thickness * float(grid.slabs);
    layers.held = uint32_t(elements.layered);
    elements.layered +=
        VkDeviceSize(layers.nodes.x) * layers.nodes.y * layers.count * (gpu::fieldQuantities(coloursOf(in)) + 1);
}

void SlabRays::recordGroup(gpu::Commands& commands, const ViewGroup& group) {
    gpu::everythingBefore(commands.handle()); // the group before has used the same buffers
    const bool rays = group.any->shared->needs_rays;
    if (features_.opaque && (rays || features_.casters)) recordEnds(commands, group); // shafts read who may cast them
    if (!rays) return;
    recordRays(commands, group);
    if (group.rate > 1) recordSpline(commands, group);
}

void SlabRays::recordEnds(gpu::Commands& commands, const ViewGroup& group) {
    const gpu::Commands::Pass pass(commands, "ray ends", group.view());
    ends_.with(constantsOf(group)).bind(commands, group.resources, {});
    vkCmdDispatch(commands.handle(), group.most([](const gpu::View& v) { return v.grid.lines.x; }),
                  group.most([](const gpu::View& v) { return v.grid.lines.y; }), group.count());
    gpu::computeToCompute(commands.handle());
}

void SlabRays::recordSpline(gpu::Commands& commands, const ViewGroup& group) {
    const gpu::Commands::Pass pass(commands, "spline", group.view());
    spline_.with(constantsOf(group)).bind(commands, group.resources, {});
    const uint32_t nodes = group.most([](const gpu::View& v) { return v.grid.nodes.x * v.grid.nodes.y; });
    vkCmdDispatch(commands.handle(), gpu::groups(nodes, 64), 1, group.count());
    gpu::computeToCompute(commands.handle());
}

gpu::FieldColours SlabRays::coloursOf(const EyeInputs& in) const {
    const bool one = in.medium->extent->one_albedo;
    const gpu::Multiple& multiple = in.shared->tick->multiple;
    const uint32_t model = scatteringOf(multiple);
    const bool one_colour = one && (model != gpu::kScatteringPropagation || multiple.channels == 1);
    // True: the sun's quantities hold what has scattered more than once, too.
    const bool in_sun =
        model == gpu::kScatteringSingle || (one == one_colour && !features_.casters && multiple.own == 0);
    return {.sun = one ? 1u : 3u,
            .ambient = features_.ambient && !(one && !features_.fog) ? 3u : 0u,
            .fog = features_.fog ? 3u : 0u,
            .glow = features_.glow || (features_.emission && !(one && !features_.fog)) ? 3u : 0u,
            .scattering = features_.local_lights && !one ? 3u : 0u,
            .lamps = features_.local_lights && !features_.fog ? 3u : 0u,
            .multiple = in_sun       ? 0u
                        : one_colour ? 1u
                                     : 3u,
            .model = model};
}

VkDeviceSize SlabRays::fieldWords(const EyeInputs& in, const gpu::SlabGrid& grid) const {
    const gpu::FieldPlanes planes{.quantities = gpu::fieldQuantities(coloursOf(in)),
                                  .faces = features_.opaque ? grid.front + grid.slabs + grid.back + 1 : 0};
    return VkDeviceSize(grid.nodes.x) * grid.nodes.y * gpu::planesOf(planes) +
           VkDeviceSize(gpu::endPlanes(planes)) * (gpu::kFieldKept + grid.caster_words) * grid.lines.x * grid.lines.y;
}

SlabRays::Bands SlabRays::bandsOf(const EyeInputs& in) const {
    Bands bands{gridOf(in, device_.lanesTogether()), 0, 0};
    gpu::SlabGrid& grid = bands.grid;
    bands.cells = gpu::groups(in.size.height, grid.rate);
    const auto tooLarge = [&] {
        const Elements elements{.added = elementsOf(in, grid).added, .field = fieldWords(in, grid)};
        return bytesOfLargest(elements) > gpu::kLargestBinding;
    };
    const auto rowsOfTiles = [&](uint32_t rows) {
        grid.lines.y = rows;
        grid.nodes.y = rows * gpu::kSlabTile;
    };
    const uint32_t beyond = raysBeyond(grid.margin);
    rowsOfTiles(gpu::groups(bands.cells + beyond, gpu::kSlabTile));
    while (grid.lines.y > 2 && tooLarge()) rowsOfTiles(gpu::groups(grid.lines.y, 2));
    while (tooLarge()) coarsen(grid);
    // The next band has the rows again that lie beyond its cells; even, since compose makes two rows of pixels at a
    // time.
    bands.step = grid.nodes.y < bands.cells + beyond ? (grid.nodes.y - beyond) & ~1u : bands.cells;
    return bands;
}

void SlabRays::grow(gpu::Buffer& buffer, VkDeviceSize bytes, const char* name) const {
    buffer.atLeast(device_, std::max<VkDeviceSize>(bytes, 256),
                   VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::device, name);
}

} // namespace brume
