// A pixel: the medium's light, from the grid's rays around it, in front of what is behind it. The grid begins MARGIN
// rays before the picture.
// own_corner, own_across, own_rise: the directions of pixels, as corner, across and rise are those of the grid.
uniform vec3 own_corner, own_across, own_rise;
uniform vec2 offset; // the picture's lower left corner in its target, pixels
uniform int rate;                              // pixels between rays
uniform sampler2DArray rays; // with a rate above 1 coefficients of a spline through them
uniform float exposure;
uniform bool filmic;
#ifdef SURFACES
uniform sampler2D surfaces, places;
#endif
#ifdef LINEAR
layout(location = 0) out vec4 radiance;
layout(location = 1) out vec4 transmittance;
#else
out vec4 colour;
#endif

#ifdef SURFACES
// The means of a ray of the grid up to a distance from the eye, m.
vec4 meansUntil(ivec2 node, float until) {
  vec3 dir = normalize(rayThrough(vec2(node) + 0.5));
  vec4 place = texelFetch(places, node, 0);
  LitRange slabs = LitRange(place.x, place.y, place.z);
  float at = (until - dot(middle, dir)) / radius, reached = (at - slabs.begin) / (slabs.end - slabs.begin);
  if (!(reached < 1.0)) return texelFetch(rays, ivec3(node, SLABS - 1), 0);
  if (reached <= 0.0) return vec4(0.0);
  int n = min(int(float(SLABS) * exp(log(reached) / slabs.power)), SLABS - 1);
  vec4 before = n > 0 ? texelFetch(rays, ivec3(node, n - 1), 0) : vec4(0.0);
  vec4 after = texelFetch(rays, ivec3(node, n), 0);
  float first = n > 1 ? texelFetch(rays, ivec3(node, n - 2), 0).a : 0.0;
  float last = n + 1 < SLABS ? texelFetch(rays, ivec3(node, n + 1), 0).a : after.a;
  vec3 depths = max(vec3(before.a - first, after.a - before.a, last - after.a), 0.0), lengths = vec3(0.0);
  for (int i = 0; i < 3; ++i)
    lengths[i] = litEdge(slabs, float(n + i) / float(SLABS)) - litEdge(slabs, float(n + i - 1) / float(SLABS));
  lengths.x = n > 0 ? lengths.x : lengths.y;
  float part = (at - litEdge(slabs, float(n) / float(SLABS))) / lengths.y;
  float depth = litBefore(depths, lengths, clamp(part, 0.0, 1.0));
  vec3 cover = covers(depths.y), covered = covers(depth);
  vec3 parts = mix(vec3(part), covered / max(cover, vec3(1e-30)), vec3(greaterThan(cover, vec3(1e-12))));
  return meansOf(mix(lightOf(before), lightOf(after), clamp(parts, 0.0, 1.0)), before.a + depth);
}
#else
vec4 meansUntil(ivec2 node, float until) { return texelFetch(rays, ivec3(node, 0), 0); }
#endif

// A cubic spline's weights of four coefficients, at a place between the two in the middle.
vec4 weights(float t) {
  float u = 1.0 - t;
  return vec4(u * u * u, 4.0 - 3.0 * t * t * (1.0 + u), 4.0 - 3.0 * u * u * (1.0 + t), t * t * t) / 6.0;
}

vec4 means(vec2 pixel, float until) {
  if (rate == 1) return meansUntil(ivec2(pixel) + MARGIN, until);
  vec2 at = (pixel - 0.5) / float(rate) + float(MARGIN), node = floor(at);
  vec4 x = weights(at.x - node.x), y = weights(at.y - node.y), sum = vec4(0.0);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) sum += x[i] * y[j] * meansUntil(ivec2(node) + ivec2(i - 1, j - 1), until);
  return max(sum, 0.0);
}

vec3 displayed(vec3 light) {
  vec3 x = max(light * exposure, 0.0);
  // Narkowicz's fit of the ACES reference curve.
  if (filmic) x = min(x, 1e4) * (2.51 * min(x, 1e4) + 0.03) / (min(x, 1e4) * (2.43 * min(x, 1e4) + 0.59) + 0.14);
  x = clamp(x, 0.0, 1.0);
  return vec3(srgb(x.r), srgb(x.g), srgb(x.b));
}

void main() {
  vec2 pixel = gl_FragCoord.xy - offset;
#ifdef SURFACES
  vec4 seen = texelFetch(surfaces, ivec2(pixel), 0);
#else
  vec4 seen = vec4(skyRadiance(normalize(own_corner + pixel.x * own_across + pixel.y * own_rise)), 1e30);
#endif
  vec4 medium = means(pixel, seen.a);
#ifdef LINEAR
  radiance = vec4(lightOf(medium), 1.0);
  transmittance = vec4(1.0 - covers(medium.a), 1.0);
#else
  colour = vec4(displayed(lightOf(medium) + (1.0 - covers(medium.a)) * seen.rgb), 1.0);
#endif
}
