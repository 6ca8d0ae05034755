// Method `lit`: the light of all lamps and of the sun is kept at nodes of world space, once a tick for all viewers. An
// eye's rays read it once in each slice, however many lights there are, and add those that are near one by one.
#include "server/methods/lit/lit_rays.h"

namespace brume::methods::lit {

std::unique_ptr<Method> make(const MethodContext& context) { return std::make_unique<LitBy<LitGrid>>(context); }

} // namespace brume::methods::lit
