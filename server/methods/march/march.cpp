// Method `march`: a few samples along the ray of every pixel, or of every second or fourth. A pattern moves the samples
// of neighbouring pixels along their rays, and a filter across these makes one picture of it (KTH 2018). The baseline
// beside which closed forms are judged.
#include <algorithm>
#include <string>

#include "server/gpu/binding_sizes.h"
#include "server/inputs/constants.h"
#include "server/methods/froxels/froxel_volume.h"
#include "server/methods/grid/medium_grid.h"
#include "server/methods/march/dither.h"
#include "server/methods/march/march_shaders.h"
#include "shaders/bilateral_comp.h"
#include "shaders/march_comp.h"
#include "shaders/march_resolve_comp.h"
#include "shaders/shared/march.h"

namespace brume::methods::march {
namespace {

constexpr uint32_t kAround = gpu::kBlurReach + 1; // marched rows beside a band that its pixels read
// Depths that differ by more are of different objects: the blur mixes nothing across 3 m.
constexpr float kDepthFalloff = 3; // m
constexpr uint32_t kBlurRun = 8;   // pixels of a lane of bilateral.comp
constexpr const char* kFormula = "ign";
static_assert(kDitherSide == gpu::kPatternSide);

// Pixels between marched ones.
uint32_t apartOf(const RenderSettings& settings) { return settings.rate >= 4 ? 4 : settings.rate >= 2 ? 2 : 1; }

// Marched columns and rows of a picture.
glm::uvec2 marchedSize(const EyeInputs& in) {
    const uint32_t apart = apartOf(*in.shared->settings);
    return {gpu::groups(in.size.width, apart), gpu::groups(in.size.height, apart)};
}

// Marched rows whose pixels are drawn together.
uint32_t bandRows(glm::uvec2 size) {
    const auto fit =
        uint32_t(std::max<VkDeviceSize>(gpu::kLargestBinding / (size.x * sizeof(glm::vec4)), 2 * kAround + 1));
    return fit >= size.y ? size.y : fit - 2 * kAround;
}

class March final : public Method {
public:
    explicit March(const MethodContext& context)
        : device_(context.device), nodes_(context.device, context.features.ellipsoids),
          march_(context.device, march_comp, "march"), blur_(context.device, bilateral_comp, "bilateral"),
          resolve_(context.device, march_resolve_comp, "march_resolve") {}

    MethodNeeds needs() const override { return {.one_medium = true, .every_pixel = true}; }

    std::span<const ViewGroup> prepare(std::span<const EyeInputs> eyes) override {
        VkDeviceSize pixels = 0;
        for (const EyeInputs& in : eyes) {
            const glm::uvec2 size = marchedSize(in);
            const uint32_t rows = std::min(bandRows(size) + 2 * kAround, size.y);
            pixels = std::max(pixels, VkDeviceSize(size.x) * rows);
        }
        const bool blurs = blurOf(eyes.front().shared->settings->march).has_value();
        const auto fit = [&](gpu::Buffer& buffer, VkDeviceSize of_pixel, const char* name) {
            buffer.atLeast(device_, pixels * of_pixel, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, name);
        };
        fit(seen_, sizeof(glm::vec4), "marched pixels");
        if (blurs) fit(blurred_, sizeof(glm::vec4), "blurred pixels");
        fit(ends_, sizeof(float), "ends of rays");
        makePattern(eyes.front().shared->settings->march.dither);
        return Method::prepare(eyes);
    }

    void recordTick(gpu::Commands& commands, const TickInputs& tick, const MediumView& medium) override {
        nodes_.record(commands, medium, *tick.settings, true);
    }

    void recordGroup(gpu::Commands& commands, const ViewGroup& group) override {
        const EyeInputs& in = *group.any;
        const RenderSettings& settings = *in.shared->settings;
        gpu::everythingBefore(commands.handle()); // the eye before has used the same buffers
        const glm::uvec2 size = marchedSize(in);
        const DepthRange range = mediumRange(in);
        gpu::MarchBand band{.size = size,
                            .first_row = 0,
                            .rate = apartOf(settings),
                            .near = range.near,
                            .far = std::max(range.far, range.near),
                            .falloff = kDepthFalloff,
                            .particles = in.medium->count > 0};
        const uint32_t most = bandRows(size);
        for (uint32_t row = 0; row < size.y; row += most) {
            const uint32_t end = std::min(row + most, size.y);
            band.first_row = row > kAround ? row - kAround : 0;
            band.size.y = std::min(end + kAround, size.y) - band.first_row;
            if (row > 0) gpu::computeToCompute(commands.handle()); // the band before is drawn
            recordMarch(commands, in, band);
            if (const auto blur = blurOf(settings.march)) recordBlur(commands, in, band, *blur);
            recordResolve(commands, in, band, {row * band.rate, end == size.y ? in.size.height : end * band.rate});
        }
    }

private:
    void makePattern(const std::string& pattern) {
        if (pattern_name_ == pattern) return;
        const std::vector<float> table = ditherTable(pattern);
        pattern_.atLeast(device_, table.size() * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload,
                         "dither");
        std::ranges::copy(table, pattern_.mapped<float>(table.size()).begin());
        pattern_.flush();
        pattern_name_ = pattern;
    }

    void recordMarch(gpu::Commands& commands, const EyeInputs& in, const gpu::MarchBand& band) {
        const gpu::Commands::Pass pass(commands, "march", in.view);
        const TickInputs& shared = *in.shared;
        const MarchSettings& settings = shared.settings->march;
        const struct {
            gpu::MarchBand band;
            gpu::MediumGrid medium;
            glm::vec3 albedo;
            uint32_t samples, formula;
        } push{band, nodes_.grid(), in.medium->extent->albedo, settings.samples, settings.dither == kFormula};
        const uint32_t jitter = jitterOf(settings);
        march_
            .with(constantsOf(shared.features), {{gpu::kIdOneAlbedo, in.medium->extent->one_albedo},
                                                 {gpu::kIdLightsAtSample, jitter != gpu::kJitterOpacity},
                                                 {gpu::kIdJitter, jitter}})
            .bind(commands, in.resources,
                  {gpu::storageBuffer("Nodes", nodes_.nodes()), gpu::storageBuffer("Seen", seen_),
                   gpu::storageBuffer("Ends", ends_), gpu::storageBuffer("Marks", nodes_.marks()),
                   gpu::storageBuffer("Pattern", pattern_)},
                  push);
        vkCmdDispatch(commands.handle(), gpu::groups(band.size.x, 8), gpu::groups(band.size.y, 8), 1);
        gpu::computeToCompute(commands.handle());
    }

    void recordBlur(gpu::Commands& commands, const EyeInputs& in, const gpu::MarchBand& band, uint32_t blur) {
        const gpu::Commands::Pass pass(commands, "bilateral", in.view);
        for (const bool down : {false, true}) {
            blur_.with({{gpu::kIdBlur, blur}, {gpu::kIdDown, down}})
                .bind(commands,
                      {gpu::storageBuffer("Ends", ends_), gpu::storageBuffer("From", down ? blurred_ : seen_),
                       gpu::storageBuffer("To", down ? seen_ : blurred_)},
                      band);
            const uint32_t columns = down ? band.size.x : gpu::groups(band.size.x, kBlurRun);
            const uint32_t rows = down ? gpu::groups(band.size.y, kBlurRun) : band.size.y;
            vkCmdDispatch(commands.handle(), gpu::groups(columns, 8), gpu::groups(rows, 8), 1);
            gpu::computeToCompute(commands.handle());
        }
    }

    // rows: of pixels: first, end.
    void recordResolve(gpu::Commands& commands, const EyeInputs& in, const gpu::MarchBand& band, glm::uvec2 rows) {
        const gpu::Commands::Pass pass(commands, "march to pixels", in.view);
        const struct {
            gpu::MarchBand band;
            glm::uvec2 rows;
        } push{band, rows};
        resolve_.with(constantsOf(in.shared->features))
            .bind(commands, in.resources, {gpu::storageBuffer("Seen", seen_), gpu::storageBuffer("Ends", ends_)}, push);
        vkCmdDispatch(commands.handle(), gpu::groups(in.size.width, 16), gpu::groups(rows.y - rows.x, 4), 1);
        gpu::computeToCompute(commands.handle());
    }

    const gpu::Device& device_;
    GridPass nodes_;
    gpu::Variants march_, blur_, resolve_;
    gpu::Buffer seen_, blurred_; // vec4[row][column]: light, opacity
    gpu::Buffer ends_;           // float[row][column]: m of view depth
    gpu::Buffer pattern_;        // float[row][column]: ditherTable()
    std::string pattern_name_;
};

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<March>(context); }

} // namespace brume::methods::march
