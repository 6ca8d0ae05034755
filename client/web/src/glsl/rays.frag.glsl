// The light of a ray's slabs from the eye to the end of each of COUNT, the first of which is FIRST.
uniform sampler2DArray slabs;

vec4 slabOf(int n) { return n < SLABS ? texelFetch(slabs, ivec3(gl_FragCoord.xy, n), 0) : vec4(0.0); }

vec4 before = vec4(0.0), own, behind;
vec3 light = vec3(0.0);
float depth = 0.0;

void add(int n) {
  behind = slabOf(n + 1);
  vec3 depths = vec3(before.a, own.a, behind.a);
  for (int c = 0; c < 3; ++c) {
    float f = factor[c];
    light[c] += exp(-f * depth) * litSlab(f * before[c], f * own[c], f * behind[c], f * depths);
  }
  depth += own.a;
  before = own;
  own = behind;
}

void main() {
  own = slabOf(0);
  for (int n = 0; n < FIRST; ++n) add(n);
#define PART(n) add(FIRST + n); part[n] = meansOf(light, depth);
  PARTS
}
