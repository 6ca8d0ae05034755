// The passes of redraw.ts: GLSL. Positions in pictures are pixels, right and down. Light is linear and exposed.
const LEAST_COVER = 0.05; // alpha that JPEG's errors alone give where there is no medium
const LEAST_SEEN = 0.3; // transmittance below which what is behind the layers is not told from the picture

export const QUAD = `#version 300 es
out vec2 place; // 0 ... 1, right and down
void main() { // one triangle that covers the viewport
  vec2 at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  place = vec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y);
  gl_Position = vec4(at, 0.0, 1.0);
}`;

// Displayed sRGB and exposed linear light; Narkowicz's curve and its inverse.
const CURVES = `
uniform bool filmic;
vec3 linear_of(vec3 srgb) {
  vec3 x = mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), greaterThan(srgb, vec3(0.04045)));
  if (!filmic) return x;
  vec3 y = min(x, 0.999), a = 2.51 - 2.43 * y, b = 0.03 - 0.59 * y, c = -0.14 * y;
  return (-b + sqrt(max(b * b - 4.0 * a * c, 0.0))) / (2.0 * a);
}
vec3 displayed(vec3 x) {
  x = max(x, 0.0);
  if (filmic) x = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
  x = clamp(x, 0.0, 1.0);
  return mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, greaterThan(x, vec3(0.0031308)));
}`;

// Coefficients of a cubic B-spline through a layer's nodes: the taps of shaders/slab_spline.comp. All blocks at once.
export const SPLINE = `#version 300 es
precision highp float;
uniform sampler2D colours, data;
uniform ivec3 lattice; // columns, rows, rows of a block
uniform int blocks, count;
${CURVES}
out vec4 colour;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int block = at.y / lattice.y;
  ivec2 node = ivec2(at.x, at.y - block * lattice.y);
  vec4 sum = vec4(0.0);
  for (int n = 0; n < 25; ++n) {
    ivec2 off = ivec2(n % 5 - 2, n / 5 - 2);
    vec2 w = vec2(abs(off.x) == 0 ? 1.59096 : abs(off.x) == 1 ? -0.33987 : 0.04439,
                  abs(off.y) == 0 ? 1.59096 : abs(off.y) == 1 ? -0.33987 : 0.04439);
    ivec2 from = clamp(node + off, ivec2(0), lattice.xy - 1) + ivec2(0, block * lattice.z);
    float through = block < count ? texelFetch(data, from, 0).r : 0.0;
    sum += w.x * w.y * vec4(linear_of(texelFetch(colours, from, 0).rgb), through);
  }
  colour = sum;
}`;

// A block of coefficients at each pixel of the picture.
export const EVERYWHERE = `#version 300 es
precision highp float;
uniform sampler2D coefficients;
uniform ivec3 lattice;
uniform vec2 nodes; // pixels between nodes, and to the first
uniform int block;
out vec4 colour;
vec4 weights(float t) {
  float u = 1.0 - t;
  return vec4(u * u * u, 4.0 + 3.0 * t * t * (t - 2.0), 4.0 + 3.0 * u * u * (u - 2.0), t * t * t) / 6.0;
}
void main() {
  vec2 node = (gl_FragCoord.xy - nodes.y) / nodes.x, low = floor(node);
  vec4 across = weights(node.x - low.x), down = weights(node.y - low.y), sum = vec4(0.0);
  for (int n = 0; n < 16; ++n) {
    ivec2 from = clamp(ivec2(low) + ivec2(n % 4 - 1, n / 4 - 1), ivec2(0), lattice.xy - 1);
    sum += across[n % 4] * down[n / 4] * texelFetch(coefficients, from + ivec2(0, block * lattice.y), 0);
  }
  colour = vec4(max(sum.rgb, 0.0), clamp(sum.a, 0.0, 1.0));
}`;

// Light of all layers together, and what they let through.
const TOGETHER = `
uniform highp sampler2DArray layers; // of each pixel: light with nothing in front, and what is let through
uniform int count;
vec4 together(ivec2 pixel) {
  vec4 all = vec4(0.0, 0.0, 0.0, 1.0);
  for (int k = 0; k < count; ++k) {
    vec4 own = texelFetch(layers, ivec3(pixel, k), 0);
    all = vec4(all.rgb + all.a * own.rgb, all.a * own.a);
  }
  return all;
}`;

// What the picture shows besides the layers, times what they let through, and the square of that: the first level of
// means.
export const REST = `#version 300 es
precision highp float;
uniform sampler2D picture;
${CURVES}${TOGETHER}
out vec4 colour;
void main() {
  vec4 all = together(ivec2(gl_FragCoord.xy));
  vec3 rest = linear_of(texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb) - all.rgb;
  colour = vec4(rest * all.a, all.a * all.a);
}`;

// What is behind the layers (drawn into the first target), and by which factor each sends more than its lattice says.
export const APART = `#version 300 es
precision highp float;
uniform sampler2D picture, means;
uniform bool sky; // true: the block after the layers' is what is behind them
uniform int levels;
${CURVES}${TOGETHER}
layout(location = 0) out vec4 behind;
layout(location = 1) out vec4 factor;
void main() {
  vec4 all = together(ivec2(gl_FragCoord.xy));
  vec3 rest = linear_of(texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb) - all.rgb, seen = vec3(0.0);
  if (sky) {
    seen = texelFetch(layers, ivec3(gl_FragCoord.xy, count), 0).rgb;
  } else { // smooth, from farther around where layers let little through
    vec2 at = gl_FragCoord.xy / vec2(textureSize(means, 0));
    float left = 1.0;
    for (int level = min(3, levels - 1); level < levels && left > 1e-3; ++level) {
      vec4 mean = textureLod(means, at, float(level));
      float part = level + 1 == levels ? left : left * min(2.0 * mean.a, 1.0);
      seen += part * mean.rgb / max(mean.a, 1e-6);
      left -= part;
    }
  }
  // What the picture shows besides, its details, belong to what is bright enough to have them.
  vec3 more = rest - all.a * seen;
  vec3 part = sky ? vec3(1.0) : all.rgb / max(all.rgb + max(all.a * seen, 0.0), 1e-4);
  vec3 times = clamp(1.0 + part * more / max(all.rgb, 1e-4), 0.25, 4.0);
  behind = vec4(seen + (more - (times - 1.0) * all.rgb) / max(all.a, ${LEAST_SEEN}), 1.0);
  factor = vec4(times, 1.0);
}`;

export const DRAW = `#version 300 es
precision highp float;
in vec2 place;
uniform sampler2D data, surface, behind, factor;
uniform int rows_apart; // of data's blocks
uniform ivec3 lattice;
uniform vec2 nodes; // pixels between nodes, and to the first
uniform vec3 from, corner, across, down; // in the picture's own view, depth last: the eye, and its rays
uniform vec4 frustum; // of the picture: left, up, and both widths
uniform vec2 size; // of the picture, pixels
uniform vec2 depths, surfaces; // m, of bytes: of layers 0 and 255, of surfaces 1 and 254
uniform float nearest; // m, of all surfaces; 0: there is nothing but sky
uniform bool see_through; // true: the sky is not drawn
${CURVES}${TOGETHER}
out vec4 colour;
const float FAR = 1e30;
vec2 pixel_of(vec3 seen) {
  return vec2(frustum.x + seen.x / seen.z, frustum.y - seen.y / seen.z) / frustum.zw * size;
}
float depth_at(int layer, vec2 pixel) {
  vec2 node = clamp((pixel - nodes.y) / nodes.x, vec2(0.0), vec2(lattice.xy - 1));
  vec2 at = vec2(node.x + 0.5, node.y + 0.5 + float((count + layer) * rows_apart));
  float byte = texture(data, at / vec2(textureSize(data, 0))).r;
  return depths.x * pow(depths.y / depths.x, byte);
}
float surface_at(vec2 pixel) {
  if (nearest <= 0.0) return FAR;
  float byte = 255.0 * texelFetch(surface, ivec2(clamp(pixel, vec2(0.0), size - 1.0)), 0).r;
  return byte > 254.5 ? FAR : surfaces.x * pow(surfaces.y / surfaces.x, max(byte - 1.0, 0.0) / 253.0);
}
vec2 place_of(vec3 dir, float inverse) { return pixel_of(from * inverse + dir * ((1.0 - from.z * inverse) / dir.z)); }
// The nearest surface on the ray. One that goes on behind what is nearer may meet another there. If it meets none, what
// lies beside the nearer one is continued.
vec2 meet_surface(vec3 dir, out float depth) {
  vec2 distant = pixel_of(dir);
  depth = FAR;
  if (nearest <= 0.0) return distant;
  float most = 1.0 / nearest;
  int steps = int(clamp(distance(place_of(dir, most), distant), 1.0, 64.0));
  float before = most;
  bool was_front = true;
  vec2 beside = distant;
  for (int i = 1; i <= steps; ++i) {
    float now = most * float(steps - i) / float(steps);
    bool front = now * surface_at(place_of(dir, now)) > 1.0;
    if (!front && was_front) {
      float near = before, far = now;
      for (int k = 0; k < 5; ++k) {
        float middle = 0.5 * (near + far);
        if (middle * surface_at(place_of(dir, middle)) > 1.0) near = middle;
        else far = middle;
      }
      vec2 there = place_of(dir, far);
      float found = surface_at(there);
      if (abs(found * far - 1.0) < 0.05 || i == steps) {
        depth = found;
        return there;
      }
      beside = floor(place_of(dir, near)) + 0.5; // not mixed with the nearer one
    }
    was_front = front;
    before = now;
  }
  if (!was_front) depth = surface_at(beside);
  return beside;
}
void main() {
  vec3 dir = corner + place.x * across + place.y * down;
  colour = vec4(0.0, 0.0, 0.0, see_through ? 0.0 : 1.0);
  if (dir.z <= 1e-3) return;
  float surface_depth;
  vec2 ends = meet_surface(dir, surface_depth);
  vec3 light = vec3(0.0);
  float through = 1.0;
  for (int k = 0; k < count; ++k) {
    vec2 at = pixel_of(dir);
    float depth = 0.0;
    for (int i = 0; i < 2; ++i) {
      depth = depth_at(k, at);
      at = pixel_of(from + dir * ((depth - from.z) / dir.z));
    }
    if (depth > surface_depth && surface_depth < 0.9 * surface_at(at)) continue; // hidden by what was beside it
    vec4 own = texture(layers, vec3(at / size, k));
    light += through * own.rgb * texture(factor, at / size).rgb;
    through *= own.a;
  }
  if (see_through && surface_depth == FAR) {
    float cover = max(1.0 - through - ${LEAST_COVER}, 0.0) / (1.0 - ${LEAST_COVER});
    colour = vec4(displayed(light) * min(cover / max(1.0 - through, 1e-3), 1.0), cover);
    return;
  }
  light += through * texture(behind, ends / size).rgb;
  colour = vec4(displayed(light), 1.0);
}`;
