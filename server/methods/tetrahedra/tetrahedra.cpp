// Method `tetrahedra`: interval shading of a mesh of tetrahedra (seed 000 section 6.2). Every pixel's ray walks from
// neighbour to neighbour, so the order is right on every ray, and nothing is sorted.
#include "server/inputs/constants.h"
#include "server/inputs/multiple_block.h"
#include "server/inputs/tetrahedra_buffers.h"
#include "server/methods/method.h"
#include "server/methods/plans.h"
#include "shaders/tetrahedra_comp.h"

namespace brume::methods::tetrahedra {
namespace {

using gpu::storageBuffer;

// Optical depth that numbers of the shadow map may differ by where light is taken from it, and not from a walk to the
// light. A soft mesh differs in many places, with errors that a line of sight averages away.
constexpr float kAgreesHard = 0.05f, kAgreesSoft = 0.3f;

class TetrahedraMethod final : public Method {
public:
    explicit TetrahedraMethod(const MethodContext& context)
        : program_(context.device, tetrahedra_comp, "tetrahedra"), nodes_(context.settings.tetrahedra.nodes) {}

    MethodNeeds needs() const override { return {.one_medium = true, .every_pixel = true}; }

    void recordGroup(gpu::Commands& commands, const ViewGroup& group) override {
        const EyeInputs& in = *group.any;
        const TickInputs& shared = *in.shared;
        const gpu::Commands::Pass pass(commands, "medium", in.view);
        const struct {
            glm::vec3 albedo;
            uint32_t faces;
            float agrees;
        } push{in.medium->extent->albedo, shared.tetrahedra->faceCount(),
               shared.tetrahedra->isHard() ? kAgreesHard : kAgreesSoft};
        program_
            .with(constantsOf(shared.features), {{gpu::kIdOneAlbedo, in.medium->extent->one_albedo},
                                                 {gpu::kIdSteps, nodes_},
                                                 {gpu::kIdScattering, scatteringOf(shared.tick->multiple)}})
            .bind(commands, in.resources,
                  {storageBuffer("Cells", shared.tetrahedra->cells), storageBuffer("Faces", shared.tetrahedra->faces),
                   storageBuffer("FaceNodes", shared.tetrahedra->nodes)},
                  push);
        vkCmdDispatch(commands.handle(), gpu::groups(in.size.width, 8), gpu::groups(in.size.height, 8), 1);
        gpu::computeToCompute(commands.handle());
    }

private:
    gpu::Variants program_;
    const uint32_t nodes_;
};

} // namespace

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<TetrahedraMethod>(context); }

} // namespace brume::methods::tetrahedra
