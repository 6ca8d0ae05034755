// Coefficients of a cubic spline through the rays of the grid: the taps of the server's slab_spline.comp.
uniform sampler2DArray rays;
const float TAPS[3] = float[](1.59096, -0.33987, 0.04439);

vec4 coefficients(int layer) {
  ivec2 last = textureSize(rays, 0).xy - 1;
  vec4 sum = vec4(0.0);
  for (int n = 0; n < 25; ++n) {
    ivec2 off = ivec2(n % 5, n / 5) - 2;
    vec2 w = vec2(TAPS[abs(off.x)], TAPS[abs(off.y)]);
    sum += w.x * w.y * texelFetch(rays, ivec3(clamp(ivec2(gl_FragCoord.xy) + off, ivec2(0), last), layer), 0);
  }
  return sum;
}

void main() {
#define PART(n) part[n] = coefficients(FIRST + n);
  PARTS
}
