// What is behind the medium: sky, ground and objects, lit by sun and sky. a: distance from the eye, m. As the server's
// lib/background.glsl has it.
uniform vec3 eye;   // m from the origin
uniform vec3 shift; // of the origin, m
uniform float near;
uniform sampler2D objects; // three texels each: kind and centre, half size and cosine of yaw, albedo and sine
uniform int count;
uniform vec3 to_light, irradiance;
uniform float haze;
// The medium's shadow.
uniform sampler2D depths;
uniform vec3 light_x, light_y;
uniform vec4 map;
uniform vec2 planes;
out vec4 surface;

const float MISS = 1e30;
const int PLANE = 0, SPHERE = 2;
// Rays of a pixel: through its middle, and four around that.
const vec2 SAMPLES[5] =
  vec2[](vec2(0.0), vec2(-0.375, 0.125), vec2(0.125, 0.375), vec2(0.375, -0.125), vec2(-0.125, -0.375));

struct Body {
  int kind;
  vec3 centre, half_size, albedo;
  vec2 yaw; // cosine, sine
};
struct Hit {
  float depth; // in units of the ray's direction
  int object;  // -1: none
  vec3 normal;
};

Body bodyOf(int i) {
  vec4 a = texelFetch(objects, ivec2(0, i), 0), b = texelFetch(objects, ivec2(1, i), 0);
  vec4 c = texelFetch(objects, ivec2(2, i), 0);
  return Body(int(a.x), a.yzw, b.xyz, c.xyz, vec2(b.w, c.w));
}
vec3 into(Body o, vec3 v) { return vec3(o.yaw.x * v.x - o.yaw.y * v.z, v.y, o.yaw.y * v.x + o.yaw.x * v.z); }
vec3 from(Body o, vec3 v) { return vec3(o.yaw.x * v.x + o.yaw.y * v.z, v.y, -o.yaw.y * v.x + o.yaw.x * v.z); }

float meet(Body o, vec3 origin, vec3 dir, out vec3 n) {
  n = vec3(0.0, 1.0, 0.0);
  if (o.kind == PLANE) {
    float t = (o.centre.y - origin.y) / dir.y;
    return dir.y < 0.0 && t > 0.0 ? t : MISS;
  }
  if (o.kind == SPHERE) { // the closest point first: no cancellation far away
    float inv = inversesqrt(dot(dir, dir));
    vec3 w = dir * inv, oc = o.centre - origin;
    float along = dot(oc, w);
    vec3 off = oc - along * w;
    float half_squared = o.half_size.x * o.half_size.x - dot(off, off);
    float t = along - sqrt(max(half_squared, 0.0));
    n = (t * w - oc) / o.half_size.x;
    return half_squared > 0.0 && t > 0.0 ? t * inv : MISS;
  }
  vec3 d = into(o, dir), p = into(o, origin - o.centre);
  vec3 inv = 1.0 / mix(d, vec3(1e-12), vec3(lessThan(abs(d), vec3(1e-12))));
  vec3 a = (-o.half_size - p) * inv, b = (o.half_size - p) * inv;
  vec3 t0 = min(a, b), t1 = max(a, b);
  float enter = max(t0.x, max(t0.y, t0.z)), leave = min(t1.x, min(t1.y, t1.z));
  n = from(o, -sign(d) * vec3(greaterThanEqual(t0, vec3(enter))));
  return enter < leave && enter > 0.0 ? enter : MISS;
}

// False: no ray near this one meets it. beside: their distance at view depth 1.
bool mayMeet(Body o, vec3 origin, vec3 dir, float beside) {
  if (o.kind == PLANE) return true;
  vec3 off = o.centre - origin, apart = cross(off, dir);
  float reach = (o.kind == SPHERE ? o.half_size.x : length(o.half_size)) + beside * length(off);
  return dot(apart, apart) <= reach * reach * dot(dir, dir);
}

Hit hits[5]; // of those rays
vec3 rays[5];

void findHits() {
  float beside = 0.61 * (length(across) + length(rise));
  for (int n = 0; n < 5; ++n) hits[n] = Hit(MISS, -1, vec3(0.0, 1.0, 0.0));
  for (int i = 0; i < count; ++i) {
    Body o = bodyOf(i);
    if (!mayMeet(o, eye, rays[0], beside)) continue;
    for (int n = 0; n < 5; ++n) {
      vec3 normal;
      float t = meet(o, eye, rays[n], normal);
      if (t >= near && t < hits[n].depth) hits[n] = Hit(t, i, normal);
    }
  }
}

// False: another body is between x and the sun.
bool isLit(vec3 x, int own) {
  vec3 normal;
  for (int i = 0; i < count; ++i) {
    Body o = bodyOf(i);
    if (i == own || o.kind == PLANE || !mayMeet(o, x, to_light, 0.0)) continue;
    if (meet(o, x, to_light, normal) < MISS) return false;
  }
  return true;
}

// Optical depth of the medium between x and the sun for a factor of 1: linear between the map's texels and planes.
float depthAbove(vec3 x) {
  float down = (planes.x - dot(to_light, x)) / planes.y;
  vec2 size = vec2(textureSize(depths, 0));
  vec2 at = (vec2(dot(light_x, x), dot(light_y, x)) - map.xy) / map.zw * size - 0.5;
  if (down <= 0.0 || any(lessThan(at, vec2(0.0))) || any(greaterThan(at, size - 1.0))) return 0.0;
  ivec2 texel = min(ivec2(at), ivec2(size) - 2);
  vec2 part = at - vec2(texel);
  vec4 four = mix(mix(texelFetch(depths, texel, 0), texelFetch(depths, texel + ivec2(1, 0), 0), part.x),
                  mix(texelFetch(depths, texel + ivec2(0, 1), 0), texelFetch(depths, texel + 1, 0), part.x), part.y);
  return four.x + dot(clamp(down - vec3(0.0, 1.0, 2.0), 0.0, 1.0), four.yzw - four.xyz);
}

vec3 skyLight(vec3 n) { return horizon * skySeen(n.y) + (zenith - horizon) * skyZenithSeen(n.y); }

// lit: the part of the sun that no body hides.
vec3 shade(vec3 dir, Hit hit, float lit) {
  float size = length(dir);
  vec3 w = dir / size, sky = skyRadiance(w);
  if (hit.object < 0) return sky;
  Body o = bodyOf(hit.object);
  vec3 x = eye + hit.depth * dir, albedo = o.albedo;
  if (o.kind == PLANE && o.half_size.x > 0.0) {
    vec3 a = groundFootprint(dir, across, hit.depth), b = groundFootprint(dir, rise, hit.depth);
    vec2 at = x.xz + shift.xz;
    albedo = groundAlbedo(albedo, o.half_size.x, groundStructure(at.x, at.y, a, b, o.half_size.y));
  }
  float direct = max(dot(hit.normal, to_light), 0.0) / 3.14159265 * lit;
  vec3 light = skyLight(hit.normal);
  if (direct > 0.0) light += irradiance * direct * exp(-factor * depthAbove(x));
  vec3 seen = albedo * light;
  return haze > 0.0 ? mix(sky, seen, exp(-haze * hit.depth * size)) : seen;
}

// The part of the sun that no body hides from what a ray has hit.
float litPartOf(int n) {
  Hit hit = hits[n];
  if (hit.object < 0 || dot(hit.normal, to_light) <= 0.0) return 0.0;
  return isLit(eye + hit.depth * rays[n], hit.object) ? 1.0 : 0.0;
}

void main() {
  vec2 pixel = gl_FragCoord.xy;
  for (int n = 0; n < 5; ++n) rays[n] = rayThrough(pixel + SAMPLES[n]);
  findHits();
  bool edge = false;
  float lit = 0.0; // of the four rays, a mean: edges of shadows are smooth as well
  for (int n = 1; n < 5; ++n) {
    edge = edge || hits[n].object != hits[0].object;
    lit += 0.25 * litPartOf(n);
  }
  vec3 colour = edge ? vec3(0.0) : shade(rays[0], hits[0], lit);
  if (edge)
    for (int n = 1; n < 5; ++n) colour += 0.25 * shade(rays[n], hits[n], litPartOf(n));
  surface = vec4(colour, hits[0].object < 0 ? MISS : hits[0].depth * length(rays[0]));
}
