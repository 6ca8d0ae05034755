// Optical depth of a particle above four planes.
uniform vec4 map;
uniform vec2 planes; // height of the first, and from one to the next, m
uniform float texels; // of the map, a side
flat in vec4 body;
flat in float sigma;
out vec4 depths;
void main() {
  vec2 off = body.w * (map.xy + gl_FragCoord.xy / texels * map.zw - body.xy);
  float across = exp(-dot(off, off));
  vec4 sum;
  for (int n = 0; n < 4; ++n)
    sum[n] = lightDepth(sigma, body.w, across, body.w * (planes.x - float(n) * planes.y - body.z));
  depths = sum;
}
