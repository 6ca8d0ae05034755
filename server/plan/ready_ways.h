// ReadyWays: what the plan asks of those who compile shaders.
#pragma once

#include "common/scene.h"

namespace brume {

// A way is a method with its settings. `full`: of pictures in full colour, as still ones and those of several hues are.
// Thread-safe.
class ReadyWays {
public:
    virtual ~ReadyWays() = default;
    // True: pictures can be drawn this way at once.
    virtual bool has(const RenderSettings& way, bool full) const = 0;
    // Pictures are drawn this way: it stays ready.
    virtual void use(const RenderSettings& way, bool full) = 0;
    // Pictures would be drawn this way if it were ready.
    virtual void want(const RenderSettings& way, bool full) = 0;
};

} // namespace brume
