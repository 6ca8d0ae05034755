// What a particle adds to the slabs of a ray: optical depth times source, and optical depth.
uniform sampler2D places;
uniform vec3 channels[HUES]; // of each hue 1 where a channel is of it
uniform vec3 irradiance, ambient, straight, emission, cold_albedo;
uniform float mean_cosine;
flat in vec4 light[HUES];
flat in vec3 bend[HUES];
flat in vec3 twist[HUES];
#if FLUENCES > 0
flat in vec4 fluence[FLUENCES];
#endif

LitLine lines[HUES];
vec3 beam, rest; // light that the sun sends to the eye where nothing is before it; and all other

vec4 inSlab(LitSums from, LitSums to) {
  vec3 lit = vec3(0.0);
  float depth = 0.0;
  for (int h = 0; h < HUES; ++h) {
    LitPart part = litPart(line, lines[h], from, to);
    lit += part.lit * channels[h];
    depth = part.depth;
  }
#if FLUENCES > 0
  // What scattered straight on comes from where the sun is, too.
  lit = depth * pow(max(lit / max(depth, 1e-30), 1e-6), straight);
#endif
  vec3 own = emitted(emission, cold_albedo, 1.0, matter.yzw);
  return vec4(matter.yzw * (beam * lit + rest * depth) + own * depth, depth);
}

LitRange slabs; // in units of the medium's radius

LitSums before(int n) {
  if (n == 0) return litSums(near_at);
  if (n == SLABS) return LitSums(0.5, 0.0, 0.25); // behind the last one: all of the particle
  return litSums(body.w * (litEdge(slabs, float(n) / float(SLABS)) * radius - closest));
}

#define PART(n) \
  to = before(FIRST + n + 1); \
  part[n] = inSlab(from, to); \
  from = to;

void main() {
  meet();
  vec4 place = texelFetch(places, ivec2(gl_FragCoord.xy), 0);
  slabs = LitRange(place.x, place.y, place.z);
  for (int h = 0; h < HUES; ++h) lines[h] = litLine(LitFit(light[h].x, light[h].yzw, bend[h], twist[h]), nearest, w);
  beam = irradiance * place.w;
  rest = ambient;
#if FLUENCES == 1
  rest += irradiance * scatteredFluence(fluence[0].w, fluence[0].xyz, mean_cosine, -w);
#elif FLUENCES == 3
  for (int c = 0; c < 3; ++c)
    rest[c] += irradiance[c] * scatteredFluence(fluence[c].w, fluence[c].xyz, mean_cosine, -w);
#endif
  LitSums from = before(FIRST), to;
  PARTS
}
