// Light of a part of a ray as its mean source, which changes less from ray to ray: what it would send if nothing could
// be seen through it. a: optical depth for a factor of 1.
uniform vec3 factor; // on the extinction, of each channel

vec3 covers(float depth) {
  if (factor.x == factor.y && factor.y == factor.z) return vec3(opacity(factor.x * depth));
  return vec3(opacity(factor.x * depth), opacity(factor.y * depth), opacity(factor.z * depth));
}
vec3 lightOf(vec4 means) { return means.rgb * covers(means.a); }
vec4 meansOf(vec3 light, float depth) {
  return vec4(depth > 1e-12 ? light / max(covers(depth), vec3(1e-30)) : vec3(0.0), depth);
}
