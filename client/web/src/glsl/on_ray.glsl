// A particle on a ray.
uniform float near; // view depth, m
flat in vec4 body;
flat in vec4 matter;

vec3 w;          // unit direction of the ray
float closest;   // m, distance of the particle's closest approach
vec3 nearest;    // where that is in the particle, in units of 1/k
float line;      // optical depth of the ray
float near_at;   // q of the view's near plane

void meet() {
  vec3 dir = rayThrough(gl_FragCoord.xy);
  float size = length(dir);
  w = dir / size;
  float along = dot(body.xyz, w);
  closest = dot(body.xyz - middle, w);
  nearest = body.w * (along * w - body.xyz);
  line = matter.x * exp(-dot(nearest, nearest));
  near_at = body.w * (near * size - along);
}
