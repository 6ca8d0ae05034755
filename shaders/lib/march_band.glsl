// The pixel that a marched pixel of the band is marched at. Include after lib/eye.glsl and `push.band`.

uvec2 marchedPixel(uvec2 at) {
    return min(push.band.rate * (at + uvec2(0, push.band.first_row)) + push.band.rate / 2, eye.size - 1);
}
