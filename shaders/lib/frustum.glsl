// Where one eye's picture lies at unit view depth, right and down from the view axis; include after `eye` is declared.
vec2 pictureCorner() { return vec2(dot(eye.right, eye.ray), -dot(eye.up, eye.ray)); } // the upper left one
vec2 pictureHalf() { return vec2(eye.tan_x, eye.tan_y); }
vec2 pictureMiddle() { return pictureCorner() + pictureHalf(); }

// From a place at unit view depth to normalized device coordinates.
vec2 toDevice(vec2 at) { return (at - pictureMiddle()) / pictureHalf(); }
