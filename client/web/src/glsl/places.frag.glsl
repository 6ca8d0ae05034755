// Where a ray's slabs lie (LitRange, in units of the medium's radius); and the phase function, 1/sr.
uniform sampler2D range;
uniform float near;
uniform vec4 lobes;
uniform vec3 to_light;
out vec4 places;
void main() {
  vec3 dir = rayThrough(gl_FragCoord.xy);
  float size = length(dir);
  vec3 w = dir / size;
  LitRange all = litRange(texelFetch(range, ivec2(gl_FragCoord.xy), 0).xyz, (near * size - dot(middle, w)) / radius);
  float phase = phaseOfLobes(-to_light, -w, lobes.x, lobes.y, lobes.z, lobes.w);
  places = vec4(all.begin, all.end, all.power, phase);
}
