//! The structs that the shaders read, byte for byte: `shaders/types.wgsl` has the same under the same names.
//!
//! Three locks hold them together: the assertions below, a test against naga's reflection of the shader, and a test that
//! reads values back from the device.

use bytemuck::{Pod, Zeroable};

/// Declares a struct as the shader lays it out, with the offsets of its fields.
macro_rules! shader_struct {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
        pub struct $name {
            $($(#[$field_doc])* pub $field: $type,)*
        }

        impl $name {
            /// Name and offset in bytes of each field, padding included.
            pub const FIELDS: &[(&str, usize)] = &[$((stringify!($field), std::mem::offset_of!($name, $field))),*];
        }
    };
}

shader_struct! {
    /// Parameters of one dispatch.
    Params {
        /// Colour of a primary ray that hits nothing.
        background: [f32; 3],
        /// Distance of the image plane.
        near: f32,
        /// Ambient intensity.
        ambient: [f32; 3],
        /// A primary ray's hit counts beyond this.
        primary_t_min: f32,
        /// A shadow or reflection ray's hit counts beyond this.
        secondary_t_min: f32,
        /// Added to 255·c before the fraction is cut off.
        quantize_bias: f32,
        /// Place of this dispatch's first tile in the list.
        first_tile: u32,
        /// Number of spheres.
        sphere_count: u32,
        /// Number of lights.
        light_count: u32,
        /// Greatest number of reflection bounces.
        max_depth: u32,
        /// To the size that WGSL gives the struct.
        padding: [u32; 2],
    }
}

shader_struct! {
    /// What the intersection reads of a sphere.
    Shape {
        /// Centre in world space.
        center: [f32; 3],
        /// Radius in object space.
        radius: f32,
        /// World to object space.
        inv_scale: [f32; 3],
        /// Lowest index of a sphere with this very surface.
        index: u32,
    }
}

shader_struct! {
    /// What only shading reads of a sphere.
    Material {
        /// Object colour.
        color: [f32; 3],
        /// Ambient coefficient.
        ka: f32,
        /// Object to world space.
        scale: [f32; 3],
        /// Diffuse coefficient.
        kd: f32,
        /// Specular coefficient.
        ks: f32,
        /// Reflection coefficient.
        kr: f32,
        /// Specular exponent.
        n: f32,
        /// To the size that WGSL gives the struct.
        padding: u32,
    }
}

shader_struct! {
    /// One point light.
    Light {
        /// Position in world space.
        position: [f32; 3],
        /// To the alignment that WGSL gives the next vector.
        padding0: u32,
        /// Intensity.
        intensity: [f32; 3],
        /// To the size that WGSL gives the struct.
        padding1: u32,
    }
}

const _: () = {
    assert!(size_of::<Params>() == 64 && std::mem::offset_of!(Params, first_tile) == 40);
    assert!(size_of::<Shape>() == 32 && std::mem::offset_of!(Shape, inv_scale) == 16);
    assert!(size_of::<Material>() == 48 && std::mem::offset_of!(Material, ks) == 32);
    assert!(size_of::<Light>() == 32 && std::mem::offset_of!(Light, intensity) == 16);
};
