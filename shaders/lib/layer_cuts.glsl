// Cuts a ray's medium into layers with depth while it is marched, where the ray is a node of the lattice
// (shared/depth_layers.h). Include after lib/view.glsl and lib/field_planes.glsl.
layout(constant_id = kIdDepthLayers) const bool kDepthLayers = false;

layout(scalar) buffer Layered { float layered[]; };

bool is_layered = false;  // True: the ray is a node
uint layer_to;            // index of the first number of the present layer
uint layer;               // its number
float layer_step;         // what each hides of the eye's light: a part of 1
float layer_hidden = 0;   // what is hidden up to the last slab passed
float layer_depths = 0;   // integral of view depth over what the present one hides, m
float layer_before[kMostFieldQuantities]; // the ray's quantities in front of the present slab

// `hidden`: by the whole ray.
void startLayers(uvec2 ray, float hidden) {
    const DepthLayers to = layers;
    const uvec2 node = (ray - to.first) / to.every;
    layer = 0;
    layer_step = hidden / float(to.count);
    layer_to = to.held + node.y * to.nodes.x + node.x;
}

bool isLayerNode(uvec2 ray) {
    const DepthLayers to = layers;
    if (to.count == 0 || any(lessThan(ray, uvec2(to.first)))) return false;
    const uvec2 from = ray - to.first;
    return all(equal(from % to.every, uvec2(0))) && all(lessThan(from / to.every, to.nodes));
}

// Ends the present layer with the ray's quantities up to here.
void endLayer(float sum[kMostFieldQuantities]) {
    const uint apart = layers.nodes.x * layers.nodes.y;
    for (uint q = 0; q < fieldQuantities(); ++q)
        if (isHeld(q)) layered[layer_to + q * apart] = sum[q];
    layered[layer_to + fieldQuantities() * apart] = layer_depths;
    layer_to += (fieldQuantities() + 1) * apart;
    layer_depths = 0;
    ++layer;
}

// To be called before a slab in front of the surface ...
void enterLayerSlab(float sum[kMostFieldQuantities]) {
    for (uint q = 0; q < fieldQuantities(); ++q) layer_before[q] = sum[q];
}

// ... and after it, with its middle's view depth. A layer ends anywhere in a slab: what it holds varies smoothly from
// ray to ray.
void passLayerSlab(float sum[kMostFieldQuantities], float middle, float thickness) {
    const float before = opacity(layer_before[kFieldDepth]), own = opacity(sum[kFieldDepth]) - before;
    if (!(own > 0)) return;
    float begin = 0; // of the layer, as a part of the slab
    while (layer + 1 < layers.count) {
        const float end = (float(layer + 1) * layer_step - before) / own;
        if (end > 1) break;
        layer_depths += own * max(end - begin, 0) * (middle + thickness * (0.5 * (begin + end) - 0.5));
        float cut[kMostFieldQuantities];
        for (uint q = 0; q < fieldQuantities(); ++q) cut[q] = mix(layer_before[q], sum[q], max(end, 0));
        endLayer(cut);
        begin = max(end, 0);
    }
    layer_depths += own * (1 - begin) * (middle + thickness * 0.5 * begin);
    layer_hidden = before + own;
}

// The rest of the ray, which ends at view depth `depth`.
void endLayers(float sum[kMostFieldQuantities], float depth) {
    layer_depths += max(opacity(sum[kFieldDepth]) - layer_hidden, 0) * depth;
    while (layer < layers.count) endLayer(sum);
}
