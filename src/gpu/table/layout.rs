//! The structs that the shaders read, byte for byte: `shaders/types.wgsl` has the same under the same names.
//!
//! Three locks hold them together: the assertions below, a test against naga's reflection of the shader, and a test that
//! reads values back from the device.

use bytemuck::Pod;
use glam::{DVec3, UVec3};

use crate::accel;
use crate::scene;

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

/// The parameters before they are rounded.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs, reason = "the fields are those of Params")]
pub struct ParamValues {
    pub background: DVec3,
    pub ambient: DVec3,
    pub primary_t_min: f64,
    pub shadow_t_min: f64,
    pub reflection_t_min: f64,
    pub quantize_scale: f64,
    pub quantize_bias: f64,
    pub window_rows: u32,
    pub lists: ListValues,
    pub window_low: u32,
    pub light_count: u32,
    pub max_depth: u32,
    pub tangent_margin: f64,
    pub cones: ConeValues,
}

/// What certified pictures need.
#[derive(Debug, Clone, Copy, Default)]
#[allow(missing_docs, reason = "the fields are those of Params")]
pub struct ConeValues {
    pub direction_error: f64,
    pub middle: DVec3,
    pub extent: f64,
    pub allowance: f64,
    pub light_allowance: f64,
    pub background_levels: f64,
    pub moved: f64,
    pub position_error: f64,
}

/// Where the lists of spheres are.
#[derive(Debug, Clone, Copy, Default)]
#[allow(missing_docs, reason = "the fields are those of Params")]
pub struct ListValues {
    pub grid_low: DVec3,
    pub screen_shift: u32,
    pub grid_per_unit: DVec3,
    pub screen_across: u32,
    pub grid_cells: UVec3,
    pub grid_first: u32,
    pub grid_entries: u32,
    pub light_slack: f64,
}

/// A shape before it is rounded.
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs, reason = "the fields are those of Shape")]
pub struct ShapeValues {
    pub center: DVec3,
    pub radius: f64,
    pub inv_scale: DVec3,
    pub index: u32,
}

/// The structs of one scalar and how they are filled.
#[allow(missing_docs, reason = "one item for each struct")]
pub trait Layout {
    type Params: Pod;
    type Shape: Pod;
    type Material: Pod;
    type Light: Pod;
    type Face: Pod;
    type Glass: Pod;
    /// The scalar.
    type Real: Pod;
    /// Its unit roundoff.
    const UNIT: f64;
    /// The nearest scalar.
    fn real(x: f64) -> Self::Real;
    /// What rounding to the scalar takes from `x`.
    fn residual(x: f64) -> f64;
    fn params(values: &ParamValues) -> Self::Params;
    fn shape(values: &ShapeValues) -> Self::Shape;
    /// The halves of a shape, which are texels or two of them.
    fn halves(shape: Self::Shape) -> [[Self::Real; 4]; 2];
    /// `ambient` are the levels of its ambient light, as a number.
    fn material(sphere: &scene::Sphere, scale: DVec3, ambient: f64) -> Self::Material;
    fn light(light: &scene::Light) -> Self::Light;
    /// `base` is where in the cells those of the light begin.
    fn face(face: &accel::Face, base: u32) -> Self::Face;
    fn glass(sphere: &scene::Sphere) -> Self::Glass;
}

/// Declares the structs for one scalar, with the numbers of `u32` that pad each.
macro_rules! layout {
    ($(#[$doc:meta])* $module:ident, $real:ty, params $params0:literal $params1:literal $params2:literal, shape $shape:literal, light $light:literal, face $face:literal) => {
        $(#[$doc])*
        pub mod $module {
            use bytemuck::{Pod, Zeroable};
            use glam::DVec3;

            use super::{ParamValues, ShapeValues};
            use crate::{accel, scene};

            shader_struct! {
                /// Parameters of one dispatch.
                Params {
                    /// Colour of a primary ray that hits nothing.
                    background: [$real; 3],
                    /// A primary ray's hit counts beyond this.
                    primary_t_min: $real,
                    /// Ambient intensity.
                    ambient: [$real; 3],
                    /// A blocker counts beyond this part of the way to the light.
                    shadow_t_min: $real,
                    /// A reflection ray's hit counts beyond this.
                    reflection_t_min: $real,
                    /// Added to a colour's level before the fraction is cut off.
                    quantize_bias: $real,
                    /// What a blocker must be farther from the light than a point to end a light's list.
                    light_slack: $real,
                    /// Where in the window the rows begin.
                    window_rows: u32,
                    /// To the alignment that WGSL gives the next vector.
                    padding0: [u32; $params0],
                    /// The corner of the grid with the least coordinates.
                    grid_low: [f32; 3],
                    /// Shift from pixels to the tiles that have lists.
                    screen_shift: u32,
                    /// Cells of the grid per unit of length.
                    grid_per_unit: [f32; 3],
                    /// Tiles with lists in a row.
                    screen_across: u32,
                    /// Number of cells along each axis.
                    grid_cells: [u32; 3],
                    /// Where in the cells those of the grid begin.
                    grid_first: u32,
                    /// Where in the window begins what rounding took from its columns and rows.
                    window_low: u32,
                    /// Number of lights.
                    light_count: u32,
                    /// Greatest number of reflection bounces.
                    max_depth: u32,
                    /// 0, which no compiler knows.
                    zero: u32,
                    /// Where in the entries those of the grid begin.
                    grid_entries: u32,
                    /// A primary ray with a discriminant below this, in radii squared, may touch a sphere or not.
                    tangent_margin: f32,
                    /// What a colour is multiplied by to be a level.
                    quantize_scale: $real,
                    /// Error of the direction of a primary ray, as an angle.
                    direction_error: $real,
                    /// To the alignment that WGSL gives the next vector.
                    padding1: [u32; $params1],
                    /// Middle of a ball around all spheres.
                    middle: [$real; 3],
                    /// Its radius.
                    extent: $real,
                    /// How far a ray that leaves a surface may lie beside where lists take it.
                    allowance: $real,
                    /// Likewise one to a light.
                    light_allowance: $real,
                    /// Levels of the background, as a number.
                    background_levels: $real,
                    /// What rounding takes of all places when the eye is moved to the origin.
                    moved: $real,
                    /// Error of the origin of a primary ray.
                    position_error: $real,
                    /// To the size that WGSL gives the struct.
                    padding2: [u32; $params2],
                }
            }

            shader_struct! {
                /// What the intersection reads of a sphere.
                Shape {
                    /// Centre in world space and radius in object space.
                    center_radius: [$real; 4],
                    /// World to object space.
                    inv_scale: [$real; 3],
                    /// Lowest index of a sphere with this very surface.
                    index: u32,
                    /// To the size that WGSL gives the struct.
                    padding: [u32; $shape],
                }
            }

            shader_struct! {
                /// What only shading reads of a sphere.
                Material {
                    /// Object colour.
                    color: [$real; 3],
                    /// Ambient coefficient.
                    ka: $real,
                    /// Diffuse coefficient.
                    kd: $real,
                    /// Specular coefficient.
                    ks: $real,
                    /// Reflection coefficient.
                    kr: $real,
                    /// Specular exponent.
                    n: $real,
                    /// Object to world space.
                    scale: [$real; 3],
                    /// Levels of its ambient light, as a number.
                    ambient_levels: $real,
                }
            }

            shader_struct! {
                /// One point light.
                Light {
                    /// Position in world space.
                    position: [$real; 3],
                    /// To the alignment that WGSL gives the next vector.
                    padding0: [u32; $light],
                    /// Intensity.
                    intensity: [$real; 3],
                    /// To the size that WGSL gives the struct.
                    padding1: [u32; $light],
                }
            }

            shader_struct! {
                /// One side of the cube of directions around a light.
                Face {
                    /// Least u and v of any sphere.
                    low: [$real; 2],
                    /// Cells per unit of u and v.
                    per_unit: $real,
                    /// To the end of the vector.
                    padding0: [u32; $face],
                    /// Number of cells along u and v.
                    cells: [u32; 2],
                    /// Where in the cells its own begin.
                    first: u32,
                    /// To the size that WGSL gives the struct.
                    padding1: [u32; 1],
                }
            }

            shader_struct! {
                /// What only refraction reads of a sphere.
                Glass {
                    /// Transmission coefficient.
                    kt: $real,
                    /// Index of refraction of the inside relative to the outside.
                    eta: $real,
                    /// 1/`eta`.
                    inv_eta: $real,
                }
            }

            /// Packs into these structs; every number is rounded once, to the nearest.
            #[derive(Debug, Clone, Copy)]
            pub struct Layout;

            impl super::Layout for Layout {
                type Params = Params;
                type Shape = Shape;
                type Material = Material;
                type Light = Light;
                type Face = Face;
                type Glass = Glass;
                type Real = $real;
                const UNIT: f64 = <$real>::EPSILON as f64 / 2.0;

                fn real(x: f64) -> $real {
                    x as $real
                }

                fn residual(x: f64) -> f64 {
                    x - f64::from(x as $real)
                }

                fn params(values: &ParamValues) -> Params {
                    Params {
                        background: vector(values.background),
                        ambient: vector(values.ambient),
                        primary_t_min: Self::real(values.primary_t_min),
                        shadow_t_min: Self::real(values.shadow_t_min),
                        reflection_t_min: Self::real(values.reflection_t_min),
                        quantize_scale: Self::real(values.quantize_scale),
                        quantize_bias: Self::real(values.quantize_bias),
                        light_slack: Self::real(values.lists.light_slack),
                        window_rows: values.window_rows,
                        grid_low: values.lists.grid_low.as_vec3().to_array(),
                        screen_shift: values.lists.screen_shift,
                        grid_per_unit: values.lists.grid_per_unit.as_vec3().to_array(),
                        screen_across: values.lists.screen_across,
                        grid_cells: values.lists.grid_cells.to_array(),
                        grid_first: values.lists.grid_first,
                        grid_entries: values.lists.grid_entries,
                        window_low: values.window_low,
                        light_count: values.light_count,
                        max_depth: values.max_depth,
                        // Not below the margin.
                        tangent_margin: (values.tangent_margin as f32).next_up(),
                        direction_error: Self::real(values.cones.direction_error),
                        middle: vector(values.cones.middle),
                        extent: Self::real(values.cones.extent),
                        allowance: Self::real(values.cones.allowance),
                        light_allowance: Self::real(values.cones.light_allowance),
                        background_levels: Self::real(values.cones.background_levels),
                        moved: Self::real(values.cones.moved),
                        position_error: Self::real(values.cones.position_error),
                        ..Params::zeroed()
                    }
                }

                fn shape(values: &ShapeValues) -> Shape {
                    Shape {
                        center_radius: values.center.extend(values.radius).to_array().map(Self::real),
                        inv_scale: vector(values.inv_scale),
                        index: values.index,
                        ..Shape::zeroed()
                    }
                }

                fn halves(shape: Shape) -> [[$real; 4]; 2] {
                    bytemuck::cast(shape)
                }

                fn material(sphere: &scene::Sphere, scale: DVec3, ambient: f64) -> Material {
                    Material {
                        color: vector(sphere.color),
                        ka: Self::real(sphere.ka),
                        kd: Self::real(sphere.kd),
                        ks: Self::real(sphere.ks),
                        kr: Self::real(sphere.kr),
                        // 0 is another exponent than any above, all of which below this give 1.
                        n: Self::real(if sphere.n > 0.0 { sphere.n.max(f64::from(f32::MIN_POSITIVE)) } else { 0.0 }),
                        scale: vector(scale),
                        ambient_levels: Self::real(ambient),
                    }
                }

                fn light(light: &scene::Light) -> Light {
                    Light {
                        position: vector(light.position),
                        intensity: vector(light.intensity),
                        ..Light::zeroed()
                    }
                }

                fn face(face: &accel::Face, base: u32) -> Face {
                    Face {
                        low: face.low.map(Self::real),
                        per_unit: Self::real(face.per_unit),
                        first: base + face.first,
                        cells: face.cells,
                        ..Face::zeroed()
                    }
                }

                fn glass(sphere: &scene::Sphere) -> Glass {
                    Glass {
                        kt: Self::real(sphere.kt),
                        eta: Self::real(sphere.eta),
                        inv_eta: Self::real(1.0 / sphere.eta),
                    }
                }
            }

            fn vector(v: DVec3) -> [$real; 3] {
                v.to_array().map(|x| x as $real)
            }
        }
    };
}

layout!(
    /// The structs of the `f32` kernels.
    single, f32, params 0 0 3, shape 0, light 1, face 1
);
layout!(
    /// The structs of the `f64` kernels.
    double, f64, params 1 2 6, shape 1, light 2, face 2
);

const _: () = {
    assert!(size_of::<single::Params>() == 176 && std::mem::offset_of!(single::Params, window_low) == 96);
    assert!(size_of::<single::Shape>() == 32 && std::mem::offset_of!(single::Shape, inv_scale) == 16);
    assert!(size_of::<single::Material>() == 48 && std::mem::offset_of!(single::Material, scale) == 32);
    assert!(size_of::<single::Light>() == 32 && std::mem::offset_of!(single::Light, intensity) == 16);
    assert!(size_of::<single::Face>() == 32 && size_of::<double::Face>() == 48);
    assert!(size_of::<single::Glass>() == 12 && size_of::<double::Glass>() == 24);
    assert!(size_of::<double::Params>() == 288 && std::mem::offset_of!(double::Params, window_low) == 144);
    assert!(size_of::<double::Shape>() == 64 && std::mem::offset_of!(double::Shape, inv_scale) == 32);
    assert!(size_of::<double::Material>() == 96 && std::mem::offset_of!(double::Material, scale) == 64);
    assert!(size_of::<double::Light>() == 64 && std::mem::offset_of!(double::Light, intensity) == 32);
};
