#include "server/gpu/device.h"
#include "server/methods/method.h"
#include "server/methods/plans.h"

namespace brume {

#define BRUME_METHOD(name)                                                                                             \
    namespace methods::name {                                                                                          \
    const MethodPlan& plan();                                                                                          \
    std::unique_ptr<Method> make(const MethodContext& context);                                                        \
    }
#include "server/methods/list.h"
#undef BRUME_METHOD

std::unique_ptr<Method> makeMethod(const MethodContext& context) {
    const MethodPlan* wanted = planOf(context.settings.method);
    if (wanted)
        if (const std::string why = extrasRefusal(*wanted, context.features); !why.empty()) throw gpu::Error(why);
    if (wanted)
        if (const std::string why = mediumRefusal(*wanted, context.features); !why.empty()) throw gpu::Error(why);
    if (wanted)
        if (const std::string why = scatteringRefusal(*wanted, context.settings); !why.empty()) throw gpu::Error(why);
#define BRUME_METHOD(name)                                                                                             \
    if (wanted == &methods::name::plan()) return methods::name::make(context);
#include "server/methods/list.h"
#undef BRUME_METHOD
    throw gpu::Error(checkSettings(context.settings));
}

} // namespace brume
