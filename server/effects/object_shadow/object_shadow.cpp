// Effect `object_shadow`: maps of what throws the sun's shadow: boxes and spheres, and meshes. They are kept until the
// sun or an object moves; meshes do not.
#include "server/effects/effect.h"
#include "server/effects/made_for.h"
#include "server/effects/object_shadow/mesh_shadow.h"
#include "server/effects/object_shadow/opaque_shadow.h"

namespace brume::effects::object_shadow {
namespace {

class ObjectShadow final : public Effect {
public:
    explicit ObjectShadow(const gpu::Device& device)
        : bodies_(device), meshes_(device), nearest_(device, VK_FILTER_NEAREST) {}

    void recordTick(gpu::Commands& commands, const EffectInputs& in, TickInputs& tick) override {
        const gpu::Tick& t = *tick.tick;
        if (bodies_made_for_.outdated({t.sun.to_light, t.map.opaque_size, tick.objects_version}))
            bodies_.record(commands, in.all.resources, t, in.objects);
        // Without meshes the sun does not matter.
        if (meshes_made_for_.outdated({t.triangle_count > 0 ? t.sun.to_light : glm::vec3(0), t.mesh_size}))
            meshes_.record(commands, in.all.resources, t);
        tick.resources.give(gpu::sampledImage("opaque_shadow", bodies_.image(), nearest_));
        tick.resources.give(gpu::sampledImage("mesh_heights", meshes_.heights(), nearest_));
        tick.resources.give(gpu::storageBuffer("MeshPyramid", meshes_.pyramid()));
    }

private:
    struct Key {
        glm::vec3 to_light{0};
        uint32_t size = 0; // texels of the map's side
        uint64_t objects = 0;
        bool operator==(const Key&) const = default;
    };

    OpaqueShadow bodies_;
    MeshShadow meshes_;
    gpu::Sampler nearest_;
    MadeFor<Key> bodies_made_for_, meshes_made_for_;
};

} // namespace

std::unique_ptr<Effect> make(const EffectContext& context) { return std::make_unique<ObjectShadow>(context.device); }

} // namespace brume::effects::object_shadow
