// A ray through the medium that is marched in slices, and where samples lie in them. Include after lib/eye.glsl.

vec3 ray_dir, ray_unit; // of unit view depth, and of unit length
float ray_metres;       // length of ray_dir
uvec2 ray_pixel;        // the pixel that the ray belongs to
uint ray_slice;         // the slice that is added
float slice_part = 0.5; // where its sample lies, from its near face to its far one
float angle_part = 0.5; // where light of points and spots is looked up, as a part of the angle that they see

// View depth of the sample.
float sampledDepth(float near, float far) { return near + slice_part * (far - near); }

void aimRay(vec2 pixel) {
    ray_dir = rayDirection(pixel);
    ray_metres = length(ray_dir);
    ray_unit = ray_dir / ray_metres;
    ray_pixel = min(uvec2(pixel), eye.size - 1);
}
