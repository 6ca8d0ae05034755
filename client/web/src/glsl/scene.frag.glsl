// Another renderer's picture as the medium's passes take it: linear light, and as alpha the distance from the eye, m.
// Where it has drawn nothing there is the sky.
uniform sampler2D colours, depths; // light times alpha; depth buffer, 0 ... 1
uniform vec2 projection;           // the projection's row 3: its columns 3 and 4
uniform vec4 sides;                // tangents: of the left and lower side, and what is between opposite sides
uniform vec3 right, up, ahead;     // of the camera, in the world
out vec4 surface;
void main() {
  vec2 at = sides.xy + gl_FragCoord.xy / vec2(textureSize(colours, 0)) * sides.zw;
  vec3 dir = ahead + at.x * right + at.y * up;
  vec4 colour = texelFetch(colours, ivec2(gl_FragCoord.xy), 0);
  float depth = texelFetch(depths, ivec2(gl_FragCoord.xy), 0).r;
  float metresAhead = projection.y / (2.0 * depth - 1.0 + projection.x);
  surface.rgb = colour.rgb + (1.0 - colour.a) * skyRadiance(normalize(dir));
  surface.a = depth < 1.0 ? metresAhead * length(dir) : 1e30;
}
