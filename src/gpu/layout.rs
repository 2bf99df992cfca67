//! The structs that the shaders read, byte for byte: `shaders/types.wgsl` has the same under the same names.
//!
//! Three locks hold them together: the assertions below, a test against naga's reflection of the shader, and a test that
//! reads values back from the device.

use bytemuck::{Pod, Zeroable};

/// Parameters of one dispatch.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Params {
    /// Colour of a primary ray that hits nothing.
    pub background: [f32; 3],
    /// Distance of the image plane.
    pub near: f32,
    /// Ambient intensity.
    pub ambient: [f32; 3],
    /// A primary ray's hit counts beyond this.
    pub primary_t_min: f32,
    /// A shadow or reflection ray's hit counts beyond this.
    pub secondary_t_min: f32,
    /// Added to 255·c before the fraction is cut off.
    pub quantize_bias: f32,
    /// Place of this dispatch's first tile in the list.
    pub first_tile: u32,
    /// Number of spheres.
    pub sphere_count: u32,
    /// Number of lights.
    pub light_count: u32,
    /// Greatest number of reflection bounces.
    pub max_depth: u32,
    /// To the size that WGSL gives the struct.
    pub padding: [u32; 2],
}

/// What the intersection reads of a sphere.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Shape {
    /// Centre in world space.
    pub center: [f32; 3],
    /// Radius in object space.
    pub radius: f32,
    /// World to object space.
    pub inv_scale: [f32; 3],
    /// Lowest index of a sphere with this very surface.
    pub index: u32,
}

/// What only shading reads of a sphere.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Material {
    /// Object colour.
    pub color: [f32; 3],
    /// Ambient coefficient.
    pub ka: f32,
    /// Object to world space.
    pub scale: [f32; 3],
    /// Diffuse coefficient.
    pub kd: f32,
    /// Specular coefficient.
    pub ks: f32,
    /// Reflection coefficient.
    pub kr: f32,
    /// Specular exponent.
    pub n: f32,
    /// To the size that WGSL gives the struct.
    pub padding: u32,
}

/// One point light.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Light {
    /// Position in world space.
    pub position: [f32; 3],
    /// To the alignment that WGSL gives the next vector.
    pub padding0: u32,
    /// Intensity.
    pub intensity: [f32; 3],
    /// To the size that WGSL gives the struct.
    pub padding1: u32,
}

const _: () = {
    assert!(size_of::<Params>() == 64 && std::mem::offset_of!(Params, first_tile) == 40);
    assert!(size_of::<Shape>() == 32 && std::mem::offset_of!(Shape, inv_scale) == 16);
    assert!(size_of::<Material>() == 48 && std::mem::offset_of!(Material, ks) == 32);
    assert!(size_of::<Light>() == 32 && std::mem::offset_of!(Light, intensity) == 16);
};
