// What pictures without sharp edges show, on a coarse grid of pixels: the display's Y as a float, then Cb and Cr in one word, of each
// node. Nodes begin one step up and left of the view's first pixel. Include after lib/view.glsl.
layout(constant_id = 22) const uint kStep = 4; // pixels between nodes

uvec2 shadedNodes(uint rows) { return (uvec2(eye.size.x, rows) + kStep - 1) / kStep + 3; } // `rows`: of pixels
