// What a particle adds to the moments of a ray's medium, in units of the medium's radius.
out vec4 moments;
void main() {
  meet();
  moments = vec4(litMoments(line, body.w * radius, closest / radius, litSums(near_at)), 0.0);
}
