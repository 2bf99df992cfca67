// Six of each light. The length is 6 MAX_UNIFORM_LIGHTS of src/gpu/pipeline.rs.
@group(0) @binding(14) var<uniform> faces: array<Face, 192>;
