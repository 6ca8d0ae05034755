// A particle's square on the map of the light that passes the medium: light space, m from the origin.
layout(location = 0) in vec4 place;
layout(location = 1) in vec4 look;
uniform vec3 light_x, light_y, to_light;
uniform vec4 map; // lower corner and size, m
uniform float falloff, thickest;
flat out vec4 body;    // centre in light space; k
flat out float sigma;

void main() {
  vec3 centre = vec3(dot(light_x, place.xyz), dot(light_y, place.xyz), dot(to_light, place.xyz));
  float k = gaussianK(place.w, falloff);
  body = vec4(centre, k);
  sigma = look.x;
  float reach = sqrt(log(clamp(lineDepth(sigma, k, 1.0) * thickest * 1e4, 500.0, 1e30))) / k;
  vec2 side = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0);
  gl_Position = vec4(2.0 * (centre.xy + reach * side - map.xy) / map.zw - 1.0, 0, 1);
}
