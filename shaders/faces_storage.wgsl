// Six of each light.
@group(0) @binding(14) var<storage, read> faces: array<Face>;
