// A particle's square on a grid of rays: it covers all rays on which more of the particle is than can be seen.
layout(location = 0) in vec4 place; // m from the origin; scale, m
layout(location = 1) in vec4 look;  // extinction, 1/m; albedo
#ifdef HUES
layout(location = 2) in vec4 first_light;
layout(location = 3) in vec3 first_bend;
layout(location = 4) in vec3 first_twist;
#if HUES > 1
layout(location = 5) in vec4 second_light;
layout(location = 6) in vec3 second_bend;
layout(location = 7) in vec3 second_twist;
#endif
#if HUES > 2
layout(location = 8) in vec4 third_light;
layout(location = 9) in vec3 third_bend;
layout(location = 10) in vec3 third_twist;
#endif
flat out vec4 light[HUES]; // middle and slope of the fit to the sun's light
flat out vec3 bend[HUES];
flat out vec3 twist[HUES];
#if FLUENCES > 0
layout(location = 11) in vec4 first_fluence; // net flux, fluence
flat out vec4 fluence[FLUENCES];
#endif
#if FLUENCES > 1
layout(location = 12) in vec4 second_fluence;
layout(location = 13) in vec4 third_fluence;
#endif
#endif
uniform vec3 eye, right, up, ahead; // m from the origin; axes of the view
uniform vec4 frame;                 // clip = tangents * xy + zw
uniform float falloff, near;
uniform float thickest; // the largest factor on the extinction
flat out vec4 body;     // centre, m from the eye; k, 1/m
flat out vec4 matter;   // optical depth of the line through the centre; albedo

const float LEAST = 1e-4;  // optical depth that cannot be seen
const float PART = 2e-3;   // part of a particle's greatest optical depth: rays with less of it are left out

// Least and greatest tangent of the lines to a circle of radius r at depth z > r.
vec2 sides(float x, float z, float r) {
  float t = sqrt(x * x + z * z - r * r);
  return vec2((x * t - z * r) / (z * t + x * r), (x * t + z * r) / (z * t - x * r));
}

void main() {
  vec3 centre = place.xyz - eye;
  float k = gaussianK(place.w, falloff);
  float line = lineDepth(look.x, k, 1.0);
  float reach = sqrt(log(clamp(line * thickest / LEAST, 1.0 / PART, 1e30))) / k;
  body = vec4(centre, k);
  matter = vec4(line, look.yzw);
#ifdef HUES
  light[0] = first_light;
  bend[0] = first_bend;
  twist[0] = first_twist;
#if HUES > 1
  light[1] = second_light;
  bend[1] = second_bend;
  twist[1] = second_twist;
#endif
#if HUES > 2
  light[2] = third_light;
  bend[2] = third_bend;
  twist[2] = third_twist;
#endif
#if FLUENCES > 0
  fluence[0] = first_fluence;
#endif
#if FLUENCES > 1
  fluence[1] = second_fluence;
  fluence[2] = third_fluence;
#endif
#endif
  vec3 seen = vec3(dot(right, centre), dot(up, centre), dot(ahead, centre));
  vec4 square = vec4(-1.0, -1.0, 1.0, 1.0); // all, where a part of it is beside the eye
  if (seen.z > 1.001 * reach) {
    vec2 x = sides(seen.x, seen.z, reach), y = sides(seen.y, seen.z, reach);
    square = clamp(vec4(x.x, y.x, x.y, y.y) * frame.xyxy + frame.zwzw, -1.0, 1.0);
  }
  if (line <= 0.0 || seen.z < near - reach) square = vec4(2.0);
  gl_Position = vec4((gl_VertexID & 1) == 0 ? square.x : square.z, (gl_VertexID & 2) == 0 ? square.y : square.w, 0, 1);
}
