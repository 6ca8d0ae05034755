// The rectangle of one eye's picture at unit view depth, right and down from the view axis. Include after `eye` is
// declared.
vec2 pictureCorner(Eye e) { return vec2(dot(e.right, e.ray), -dot(e.up, e.ray)); } // upper left corner
vec2 pictureHalf(Eye e) { return vec2(e.tan_x, e.tan_y); }
vec2 pictureCorner() { return pictureCorner(eye); }
vec2 pictureHalf() { return pictureHalf(eye); }
vec2 pictureMiddle() { return pictureCorner() + pictureHalf(); }

// Converts a point at unit view depth to normalized device coordinates.
vec2 toDevice(vec2 at) { return (at - pictureMiddle()) / pictureHalf(); }
