//! The composed WGSL: every effect set is valid, and the structs are those of the host.

use std::collections::HashSet;
use std::num::NonZeroU32;

use trueray::accel::{Acceleration, Lists};
use trueray::camera::Camera;
use trueray::effects::{Effect, EffectSet, Effects, Request};
use trueray::gpu::layout::{double, single};
use trueray::gpu::{
    Kernel, Module, ParsedModule, SHADE_PATHS, Schedule, Secondary, SelfTest, Slots, Specialisation, Storage,
    TRACE_SAMPLES, TRACE_TILES, Tables, Variant, WALK_PATHS, echo_layout,
};

use trueray::precision::Tier;
use trueray::sampling::Fill;
use trueray::settings::Settings;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use rspirv::dr::{self, Operand};
use rspirv::spirv::{Decoration, GlslStd450Op, Op, StorageClass};

/// Every kernel, with each way to find what secondary rays meet, and some of the ways to read tables and to walk paths.
fn kinds() -> impl Iterator<Item = Variant> {
    let kernels = Tier::ALL.map(Kernel::Tier).into_iter().chain([Kernel::Pairs]);
    let in_turn = Schedule::InTurn(NonZeroU32::new(5).unwrap());
    let ways = [
        (Secondary::Grid, Tables::Stored, in_turn),
        (Secondary::Grid, Tables::Sampled, Schedule::AtOnce),
        (Secondary::Grid, Tables::Stored, Schedule::InPlace),
        // Where no sphere is in the grid, there is nothing to walk through in turn.
        (Secondary::Large, Tables::Stored, Schedule::AtOnce),
        (Secondary::Large, Tables::Sampled, Schedule::InPlace),
        (Secondary::Both, Tables::Sampled, in_turn),
        (Secondary::Both, Tables::Buffers, in_turn),
        (Secondary::Grid, Tables::Buffers, Schedule::InPlace),
        (Secondary::Grid, Tables::Stored, Schedule::First),
    ];
    kernels.flat_map(move |kernel| {
        let certified = [false, true].into_iter().filter(move |certified| !(*certified && kernel.carries_low()));
        let each = certified.flat_map(move |certified| ways.map(move |way| (certified, way)));
        each.map(move |(certified, (secondary, tables, schedule))| Variant {
            kernel,
            storage: Storage::Tables(tables),
            secondary,
            samples: false,
            refraction: None,
            slots: Slots::Tiles,
            schedule,
            certified,
            dispatch_tiles: 8,
        })
    })
}

/// What a pipeline of this variant may be specialised for.
fn specialisation(variant: &Variant, effects: EffectSet, flags: usize) -> Specialisation {
    let Variant { kernel, storage, secondary, refraction, slots, schedule, certified, .. } = *variant;
    let [shared_surfaces, blinn, count_rays] = [1, 2, 4].map(|bit| flags & bit != 0);
    let samples = if variant.samples { 2 } else { 1 };
    Specialisation {
        kernel,
        effects,
        refraction,
        shared_surfaces,
        blinn,
        storage,
        lights: 2,
        secondary,
        sphere_count: 3,
        schedule,
        samples,
        side: samples,
        parallel: blinn,
        slots,
        certified,
        linear: variant.samples && count_rays,
        count_rays,
        count_tests: !count_rays,
        one_ray: shared_surfaces,
        workgroup: 64,
        dispatch_tiles: 8,
    }
}

/// The kernels of a module.
fn entry_points(variant: &Variant) -> Vec<&'static str> {
    let trace = match variant.slots {
        Slots::Tiles => TRACE_TILES,
        Slots::List => TRACE_SAMPLES,
    };
    match (variant.refraction, variant.schedule) {
        (Some(_), _) | (None, Schedule::InPlace | Schedule::First) => vec![trace],
        (None, Schedule::AtOnce) => vec![WALK_PATHS, trace],
        (None, Schedule::InTurn(_)) => vec![WALK_PATHS, SHADE_PATHS, trace],
    }
}

fn validate(module: &naga::Module) -> naga::valid::ModuleInfo {
    Validator::new(ValidationFlags::all(), Capabilities::FLOAT64 | Capabilities::SHADER_INT64).validate(module).unwrap()
}

/// The constants that this entry point of `module` has a use for.
fn constants_read(module: &Module, entry_point: &str) -> HashSet<String> {
    let mut module = module.parse().unwrap();
    module.entry_points.retain(|entry| entry.name == entry_point);
    naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
    module.overrides.iter().filter_map(|(_, constant)| constant.name.clone()).collect()
}

#[test]
fn every_effect_set_is_valid() {
    let every: Vec<_> = EffectSet::every().collect();
    let (mut modules, mut validated) = (HashSet::new(), 0);
    for kind in kinds() {
        for refraction in [None, NonZeroU32::new(3)] {
            let variant = Variant { refraction, ..kind };
            let text = Module::render(&variant);
            if !modules.insert(text.text.clone()) {
                continue;
            }
            let module = ParsedModule::new(&text).unwrap();
            let kernels = entry_points(&variant).into_iter().map(|entry| (entry, constants_read(&text, entry)));
            for (entry_point, read) in kernels.collect::<Vec<_>>() {
                let mut seen = HashSet::new();
                for (index, &effects) in every.iter().enumerate() {
                    if effects.has(Effect::Refraction) != refraction.is_some() {
                        continue;
                    }
                    // All flags with all effects, and some with each set.
                    let flags = if effects == EffectSet::ALL { 0..8 } else { index % 8..index % 8 + 1 };
                    for flags in flags {
                        let constants = specialisation(&variant, effects, flags).constants();
                        // Those that differ in nothing that it reads are one.
                        let differs = constants.iter().filter(|(name, _)| read.contains(*name));
                        if seen.insert(differs.map(|(_, value)| value.to_bits()).collect::<Vec<_>>()) {
                            validate(&module.specialised(entry_point, &constants).unwrap());
                        }
                    }
                }
                validated += seen.len();
            }
        }
    }
    assert!(validated > 5000, "{validated}");
}

/// What the constants of a pipeline exclude is not there for drivers to translate.
#[test]
fn kernels_have_no_branch_that_is_known() {
    fn has_known_branch(function: &naga::Function, block: &naga::Block) -> bool {
        block.iter().any(|statement| match statement {
            naga::Statement::If { condition, accept, reject } => {
                let known = matches!(
                    function.expressions[*condition],
                    naga::Expression::Literal(_) | naga::Expression::Constant(_) | naga::Expression::Override(_)
                );
                known || [accept, reject].into_iter().any(|block| has_known_branch(function, block))
            }
            naga::Statement::Loop { body, continuing, .. } => {
                [body, continuing].into_iter().any(|block| has_known_branch(function, block))
            }
            naga::Statement::Block(block) => has_known_branch(function, block),
            _ => false,
        })
    }
    for variant in kinds() {
        let module = ParsedModule::new(&Module::render(&variant)).unwrap();
        let constants = specialisation(&variant, EffectSet::NONE, 0).constants();
        for entry_point in entry_points(&variant) {
            let module = module.specialised(entry_point, &constants).unwrap();
            let functions = module.functions.iter().map(|(_, function)| function);
            for function in functions.chain(module.entry_points.iter().map(|entry| &entry.function)) {
                assert!(!has_known_branch(function, &function.body), "{entry_point}: {:?}", function.name);
            }
        }
    }
}

/// The SPIR-V of this entry point.
fn kernel(module: &ParsedModule, entry_point: &str, constants: &[(&str, f64)]) -> dr::Module {
    let specialised = module.specialised(entry_point, constants).unwrap();
    dr::load_words(module.spirv(&specialised, entry_point).unwrap()).unwrap()
}

/// Every kernel that the kinds have with these flags, with all effects and with few.
fn rendering_kernels() -> impl Iterator<Item = (String, dr::Module)> {
    let few = EffectSet::NONE.with(Effect::Diffuse, true);
    let shapes = [None, NonZeroU32::new(3)]
        .into_iter()
        .flat_map(|refraction| [Slots::Tiles, Slots::List].map(|slots| (refraction, slots)));
    let variants = shapes.flat_map(|(refraction, slots)| {
        kinds().map(move |kind| Variant { refraction, slots, samples: slots == Slots::List, ..kind })
    });
    variants.flat_map(move |variant| {
        let module = ParsedModule::new(&Module::render(&variant)).unwrap();
        let sets = [(EffectSet::ALL, 7), (few, 0)].into_iter();
        sets.flat_map(move |(effects, flags)| {
            let constants = specialisation(&variant, effects, flags).constants();
            let entry_points = entry_points(&variant).into_iter();
            let named = |entry| (format!("{entry} of {variant:?}"), kernel(&module, entry, &constants));
            entry_points.map(named).collect::<Vec<_>>()
        })
        .collect::<Vec<_>>()
    })
}

/// Every kernel that does something else than render.
fn other_kernels() -> impl Iterator<Item = (String, dr::Module)> {
    let tiers = Tier::ALL.map(Kernel::Tier);
    let all = tiers.into_iter().chain([Kernel::Pairs, Kernel::Schoolbook, Kernel::NoBarrier]);
    let probes = all.map(Module::probe);
    let echoes = tiers.map(|kernel| Module::echo(kernel, Tables::Stored));
    let modules = probes.chain(echoes).chain(tiers.map(Module::resolve)).chain(Fill::ALL.map(Module::fill));
    let modules = modules.chain([Module::selftest(), Module::flood(), Module::between_bounces()]);
    modules.flat_map(|module| {
        let entry_points = module.parse().unwrap().entry_points.into_iter().map(|entry| entry.name);
        let module = ParsedModule::new(&module).unwrap();
        entry_points.map(|entry| (entry.clone(), kernel(&module, &entry, &[]))).collect::<Vec<_>>()
    })
}

#[test]
fn every_kernel_is_sound() {
    let mut count = 0;
    for (name, kernel) in rendering_kernels() {
        assert_eq!(kernel.functions.len(), 1, "{name} calls something");
        assert_well_formed(&name, &kernel);
        assert_layouts_are_allowed(&name, &kernel);
        assert!(rounded_as_written(&name, &kernel) > 20, "{name}");
        count += 1;
    }
    assert!(count > 200, "{count}");
    for (name, kernel) in other_kernels() {
        assert_well_formed(&name, &kernel);
        assert_layouts_are_allowed(&name, &kernel);
        rounded_as_written(&name, &kernel);
    }
}

/// No driver may round otherwise than it is written: one that fuses or reorders does so differently from kernel to kernel. The
/// number of operations that round.
fn rounded_as_written(name: &str, kernel: &dr::Module) -> usize {
    // What rounds once, by itself.
    const ROUNDED: [Op; 6] = [Op::FNegate, Op::FAdd, Op::FSub, Op::FMul, Op::FDiv, Op::VectorTimesScalar];
    // What does not round, or has but one way to.
    const MOVED: [Op; 10] = [
        Op::Load,
        Op::CompositeConstruct,
        Op::CompositeExtract,
        Op::CompositeInsert,
        Op::VectorShuffle,
        Op::Select,
        Op::Bitcast,
        Op::ConvertSToF,
        Op::ConvertUToF,
        Op::FConvert,
    ];
    // The others stand for several operations, which drivers fuse as they like.
    const EXTENDED: [GlslStd450Op; 6] = [
        GlslStd450Op::FAbs,
        GlslStd450Op::Floor,
        GlslStd450Op::Sqrt,
        GlslStd450Op::FMin,
        GlslStd450Op::FMax,
        GlslStd450Op::FClamp,
    ];
    let exact: HashSet<_> = kernel
        .annotations
        .iter()
        .filter(|it| it.operands[1..] == [Operand::Decoration(Decoration::NoContraction)])
        .map(|it| it.operands[0].unwrap_id_ref())
        .collect();
    let mut floats = HashSet::new();
    for ty in &kernel.types_global_values {
        let is_float = match ty.class.opcode {
            Op::TypeFloat => true,
            Op::TypeVector => floats.contains(&ty.operands[0].unwrap_id_ref()),
            _ => false,
        };
        floats.extend(ty.result_id.filter(|_| is_float));
    }
    let mut count = 0;
    for it in kernel.functions.iter().flat_map(|function| &function.blocks).flat_map(|block| &block.instructions) {
        if it.result_type.is_none_or(|ty| !floats.contains(&ty)) {
            continue;
        }
        if it.class.opcode == Op::ExtInst {
            let operation = it.operands[1].unwrap_literal_ext_inst_integer();
            assert!(EXTENDED.iter().any(|&known| known as u32 == operation), "{name}: {it:?}");
        } else if !ROUNDED.contains(&it.class.opcode) {
            assert!(MOVED.contains(&it.class.opcode), "{name}: {it:?}");
            continue;
        }
        assert!(exact.contains(&it.result_id.unwrap()), "{name}: {it:?}");
        count += 1;
    }
    count
}

/// What has an explicit layout lies in buffers; up to SPIR-V 1.4 variables of a kernel may have such types too
/// (VUID-StandaloneSpirv-None-10684).
fn assert_layouts_are_allowed(name: &str, kernel: &dr::Module) {
    let is_layout = |decoration: &Operand| {
        matches!(
            decoration,
            Operand::Decoration(Decoration::Offset | Decoration::ArrayStride | Decoration::MatrixStride)
        )
    };
    let laid_out = kernel.annotations.iter().filter(|it| it.operands.iter().any(is_layout));
    let mut laid_out: HashSet<_> = laid_out.map(|it| it.operands[0].unwrap_id_ref()).collect();
    // Types come before those that contain them.
    for ty in &kernel.types_global_values {
        if ty.operands.iter().any(|part| part.id_ref_any().is_some_and(|part| laid_out.contains(&part))) {
            laid_out.extend(ty.result_id);
        }
    }
    let may_have_layout = |class: StorageClass| match class {
        StorageClass::Uniform | StorageClass::StorageBuffer => true,
        StorageClass::Function | StorageClass::Private => kernel.header.as_ref().unwrap().version() <= (1, 4),
        _ => false,
    };
    for variable in kernel.all_inst_iter().filter(|it| it.class.opcode == Op::Variable) {
        let class = variable.operands[0].unwrap_storage_class();
        assert!(may_have_layout(class) || !laid_out.contains(&variable.result_type.unwrap()), "{name}: {variable:?}");
    }
}

/// Everything is defined once and before it is used.
fn assert_well_formed(name: &str, kernel: &dr::Module) {
    let mut defined: HashSet<_> = kernel.global_inst_iter().filter_map(|it| it.result_id).collect();
    defined.extend(kernel.functions.iter().filter_map(dr::Function::def_id));
    for function in &kernel.functions {
        let labels: Vec<_> = function.blocks.iter().map(|block| block.label_id().unwrap()).collect();
        // Branches go forward.
        defined.extend(&labels);
        assert_eq!(labels.iter().collect::<HashSet<_>>().len(), labels.len(), "{name}");
        let parameters = function.parameters.iter();
        let instructions = function.blocks.iter().flat_map(|block| &block.instructions);
        let (variables, rest): (Vec<_>, Vec<_>) = instructions.partition(|it| it.class.opcode == Op::Variable);
        for instruction in parameters.chain(variables).chain(rest) {
            let ids = instruction.operands.iter().filter_map(Operand::id_ref_any).chain(instruction.result_type);
            assert!(ids.into_iter().all(|id| defined.contains(&id)), "{name}: {instruction:?}");
            assert!(instruction.result_id.is_none_or(|id| defined.insert(id)), "{name}: {instruction:?}");
        }
    }
    let bound = kernel.header.as_ref().unwrap().bound;
    assert!(defined.iter().all(|&id| id < bound), "{name}");
}

/// Products of vectors of every size, as they are written out.
#[test]
fn products_of_vectors_are_written_out() {
    let mut module = Module::selftest();
    module.text = "
        @group(0) @binding(0) var<storage, read_write> v: array<vec4<f32>, 4>;
        @compute @workgroup_size(1) fn main() {
            let three = cross(v[0].xyz, v[1].xyz);
            v[2] = vec4(three, dot(v[0].xy, v[1].xy));
            v[3] = vec4(dot(three, v[0].xyz), dot(v[0], v[1]), f32(dot(bitcast<vec2<i32>>(v[0].xy), vec2(2, 3))), 0.0);
        }
    "
    .into();
    let kernel = kernel(&ParsedModule::new(&module).unwrap(), "main", &[]);
    assert_well_formed("products", &kernel);
    // Two products and their difference; then those of 2, 3 and 4 components and 1, 2 and 3 sums.
    assert_eq!(rounded_as_written("products", &kernel), 3 + 2 + 3 + 4);
}

/// What the shaders of this project have little of: returns before the end, pointers, variables that begin anew with each call.
#[test]
fn calls_are_inlined_but_of_functions_that_return_early() {
    let mut module = Module::selftest();
    module.text = "
        @group(0) @binding(0) var<storage, read_write> result: array<u32>;
        fn early(x: u32) -> u32 { if x > 3u { return inner(x); } return 1u; }
        fn inner(x: u32) -> u32 { var sum = 2u; for (var i = 0u; i < x; i++) { sum += i; } return sum; }
        fn same(x: u32) -> u32 { return x; }
        fn add(to: ptr<function, u32>, x: u32) { *to += same(x); }
        fn unused() -> u32 { return inner(7u); }
        @compute @workgroup_size(1) fn main() {
            var total = 0u;
            for (var i = 0u; i < 5u; i++) { add(&total, same(inner(i))); }
            result[0] = total + early(total);
        }
    "
    .into();
    let kernel = kernel(&ParsedModule::new(&module).unwrap(), "main", &[]);
    let calls =
        |function: &dr::Function| function.all_inst_iter().filter(|it| it.class.opcode == Op::FunctionCall).count();
    // The one that returns early, without its own call, and the kernel with the call of it.
    let counts: Vec<_> = kernel.functions.iter().map(calls).collect();
    assert_eq!(counts, [0, 1]);
    for function in &kernel.functions {
        let is_variable = |it: &&dr::Instruction| it.class.opcode == Op::Variable;
        let variables = function.all_inst_iter().filter(is_variable).count();
        // All at the beginning, and those of a call begin anew where it was.
        let first = &function.blocks[0].instructions;
        assert_eq!(first.iter().take_while(is_variable).count(), variables);
        assert!(variables > 0 && first.iter().filter(is_variable).all(|it| it.operands.len() == 1));
    }
    let kernel = &kernel.functions[1];
    let initial = kernel.blocks.iter().skip(1).flat_map(|block| &block.instructions);
    assert!(initial.filter(|it| it.class.opcode == Op::Store).count() >= 4);
    for block in
        kernel.blocks.iter().filter(|block| block.instructions.iter().any(|it| it.class.opcode == Op::LoopMerge))
    {
        // A loop begins in the block to which its end goes back.
        let label = block.label_id().unwrap();
        let back = kernel
            .blocks
            .iter()
            .filter(|other| other.instructions.last().unwrap().operands.contains(&Operand::IdRef(label)));
        assert_eq!(back.count(), 2, "from before and from its end");
    }
}

/// A constant that the shader does not declare would be ignored silently by the validation above.
#[test]
fn every_constant_is_an_override_and_every_override_is_set() {
    for variant in kinds().flat_map(|kind| [kind, Variant { refraction: NonZeroU32::new(1), ..kind }]) {
        let module = Module::render(&variant).parse().unwrap();
        let mut declared: Vec<_> = module.overrides.iter().map(|(_, o)| o.name.clone().unwrap()).collect();
        let specialisation = specialisation(&variant, EffectSet::ALL, 7);
        let mut set: Vec<_> = specialisation.constants().into_iter().map(|(name, _)| name.to_owned()).collect();
        declared.sort();
        set.sort();
        assert_eq!(declared, set);
    }
}

/// Scenes without Kt compile what they did before there was any refraction.
#[test]
fn only_refraction_brings_its_text() {
    for kind in kinds() {
        let [without, with] =
            [None, NonZeroU32::new(3)].map(|refraction| Module::render(&Variant { refraction, ..kind }));
        assert!(!without.text.contains("glasses") && !without.text.contains("MAX_WAITING"));
        assert!(with.text.contains("const MAX_WAITING: u32 = 3u;"));
        let (file, line) =
            with.place(with.text.lines().position(|line| line.contains("fn tree_color(")).unwrap() as u32 + 1);
        let text = std::fs::read_to_string(crate::support::root().join(&file)).unwrap();
        assert_eq!(file, "shaders/path_tree.wgsl");
        assert!(text.lines().nth(line as usize - 1).unwrap().contains("fn tree_color("));
    }
}

/// Names and offsets of the fields of a struct.
type Fields = &'static [(&'static str, usize)];

#[test]
fn structs_lie_in_memory_as_the_shader_reads_them() {
    assert_layout(
        Tier::Fast,
        [
            ("Params", single::Params::FIELDS, size_of::<single::Params>()),
            ("Shape", single::Shape::FIELDS, size_of::<single::Shape>()),
            ("Material", single::Material::FIELDS, size_of::<single::Material>()),
            ("Light", single::Light::FIELDS, size_of::<single::Light>()),
            ("Face", single::Face::FIELDS, size_of::<single::Face>()),
            ("Glass", single::Glass::FIELDS, size_of::<single::Glass>()),
        ],
    );
    assert_layout(
        Tier::Double,
        [
            ("Params", double::Params::FIELDS, size_of::<double::Params>()),
            ("Shape", double::Shape::FIELDS, size_of::<double::Shape>()),
            ("Material", double::Material::FIELDS, size_of::<double::Material>()),
            ("Light", double::Light::FIELDS, size_of::<double::Light>()),
            ("Face", double::Face::FIELDS, size_of::<double::Face>()),
            ("Glass", double::Glass::FIELDS, size_of::<double::Glass>()),
        ],
    );
}

fn assert_layout(tier: Tier, structs: [(&str, Fields, usize); 6]) {
    let module = Module::render(&Variant {
        kernel: Kernel::Tier(tier),
        refraction: NonZeroU32::new(3),
        ..kinds().next().unwrap()
    })
    .parse()
    .unwrap();
    for (name, fields, size) in structs {
        let (_, found) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name)).unwrap();
        let naga::TypeInner::Struct { members, span } = &found.inner else { panic!("{name}") };
        let shader: Vec<_> = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset as usize)).collect();
        let host: Vec<_> = fields.iter().copied().filter(|(field, _)| !field.starts_with("padding")).collect();
        assert_eq!(host, shader, "{name}");
        assert_eq!(size, *span as usize, "{name}");
    }
}

#[test]
fn the_modules_are_valid_and_have_their_entry_points() {
    let found = |module: Module| {
        let module = module.parse().unwrap();
        validate(&module);
        let mut names: Vec<_> = module.entry_points.into_iter().map(|entry| entry.name).collect();
        names.sort();
        names
    };
    assert_eq!(found(Module::between_bounces()), ["begin_bounce"]);
    for kind in kinds() {
        assert_eq!(found(Module::resolve(kind.kernel)), ["resolve"]);
        for (samples, refraction, slots) in [
            (false, None, Slots::Tiles),
            (true, None, Slots::List),
            (false, NonZeroU32::new(3), Slots::List),
            (true, NonZeroU32::new(3), Slots::Tiles),
        ] {
            let variant = Variant { samples, refraction, slots, ..kind };
            let mut expected = entry_points(&variant);
            expected.sort_unstable();
            assert_eq!(found(Module::render(&variant)), expected);
        }
    }
    assert_eq!(found(Module::flood()), ["jump"]);
    for fill in Fill::ALL {
        assert_eq!(found(Module::fill(fill)), ["fill"]);
    }
}

#[test]
fn no_two_bindings_have_the_same_number() {
    for variant in kinds().flat_map(|kind| [kind, Variant { refraction: NonZeroU32::new(3), ..kind }]) {
        let module = Module::render(&variant).parse().unwrap();
        let mut bindings: Vec<_> =
            module.global_variables.iter().filter_map(|(_, v)| v.binding.map(|binding| binding.binding)).collect();
        let count = bindings.len();
        bindings.sort_unstable();
        bindings.dedup();
        assert_eq!(bindings.len(), count);
    }
}

#[test]
fn an_error_in_the_shader_names_its_file_and_line() {
    let mut module = Module::render(&kinds().next().unwrap());
    let line = 1 + module.text.lines().position(|line| line.contains("fn reflection_ray(")).unwrap() as u32;
    let (file, line_in_file) = module.place(line);
    assert_eq!(file, "shaders/reflect.wgsl");
    let text = std::fs::read_to_string(crate::support::root().join(&file)).unwrap();
    assert!(text.lines().nth(line_in_file as usize - 1).unwrap().contains("fn reflection_ray("));

    module.text = module.text.replace("fn reflection_ray(surface: Surface)", "fn reflection_ray(surface: Surfaze)");
    let error = module.parse().unwrap_err();
    assert!(error.contains(&format!("shaders/reflect.wgsl:{line_in_file}:")), "{error}");
    assert_eq!(ParsedModule::new(&module).unwrap_err(), error);
}

#[test]
fn error_free_transforms_are_exact_on_this_device() {
    let Some(gpu) = crate::support::gpu("error_free_transforms_are_exact_on_this_device") else { return };
    validate(&Module::selftest().parse().unwrap());
    let test = SelfTest::run(&gpu).unwrap();
    // A device that fails is refused by the tier that needs them; the software drivers of the CI do not.
    assert_eq!((test.sum_mismatches, test.product_mismatches), (0, 0), "{}", gpu.device.info);
    assert_eq!(gpu.kernel(Tier::Robust), Ok(Kernel::Tier(Tier::Robust)));
}

/// The third lock: what the device reads is what the host packed, field by field.
#[test]
fn the_device_reads_every_field_where_the_host_wrote_it() {
    let Some(gpu) = crate::support::gpu("the_device_reads_every_field_where_the_host_wrote_it") else { return };
    // No two numbers are the same.
    let scene = crate::support::scene_of(
        "SPHERE a 11 12 -13 2 2 2 0.01 0.02 0.03 0.04 0.05 0.06 0.07 14\n\
         SPHERE b 15 16 -17 1 4 8 0.11 0.12 0.13 0.14 0.15 0.16 0.17 18\n\
         LIGHT l 21 22 23 0.21 0.22 0.23\nBACK 0.31 0.32 0.33\nAMBIENT 0.41 0.42 0.43",
    );
    let settings = Settings { max_depth: 5, ..Settings::classic() };
    let effects = Effects::requested(&scene.viewed(&settings), &Request::Exactly(EffectSet::ALL));
    let x = |i: f32| -1.0 + 2.0 * i / 40.0;
    let expected: [&[f32]; 5] = [
        &[0.31, 0.32, 0.33, 1.0 + 1e-6, 0.41, 0.42, 0.43, 1e-3, 1e-3, 0.0],
        &[11.0, 12.0, -13.0, 1.0, 0.5, 0.5, 0.5, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 14.0, 2.0, 2.0, 2.0],
        &[15.0, 16.0, -17.0, 1.0, 1.0, 0.25, 0.125, 0.11, 0.12, 0.13, 0.14, 0.15, 0.16, 0.17, 18.0, 1.0, 4.0, 8.0],
        &[21.0, 22.0, 23.0, 0.21, 0.22, 0.23],
        &[x(2.0), -0.0, -0.0, 0.0, -x(2.0), -1.0],
    ];
    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let mut expected = expected.map(bits);
    for (sphere, index) in [(1, 0), (2, 1)] {
        expected[sphere].insert(7, index);
    }
    for kernel in Tier::ALL.into_iter().filter_map(|tier| gpu.kernel(tier).ok()) {
        let accel = Acceleration::new(&scene.viewed(&settings), effects.set, kernel.rounding().certified());
        let grid = accel.grid.unwrap();
        let single = |x: f64| (x as f32).to_bits();
        let mut expected = expected.clone();
        expected[0].extend([single(accel.lights.slack), 40]);
        expected[0].extend(grid.low.to_array().map(single));
        expected[0].push(accel.screen.shift);
        expected[0].extend(grid.per_unit.to_array().map(single));
        expected[0].push(accel.screen.across);
        expected[0].extend(grid.cells.to_array());
        let before_grid = || std::iter::once(&accel.screen.lists).chain(&accel.lights.lists);
        let cells: usize = before_grid().map(Lists::cells).sum();
        let entries: usize = before_grid().map(|lists| lists.entries.len()).sum();
        // 40 columns and as many rows; one light.
        expected[0].extend([
            cells as u32,
            80,
            1,
            5,
            0,
            entries as u32,
            0.25_f32.next_up().to_bits(),
            255.0_f32.to_bits(),
        ]);
        let unit = if kernel.is_double() { f64::EPSILON / 2.0 } else { f64::from(f32::EPSILON) / 2.0 };
        expected[0].push(single(Camera::new(&scene.viewed(&settings)).direction_error(unit)));
        expected[0].extend(accel.middle.to_array().map(single));
        expected[0].extend([accel.extent, accel.allowance, accel.light_allowance].map(single));
        // Levels as one number, red in the low byte.
        let levels = |[red, green, blue]: [u8; 3]| single(f64::from(u32::from_le_bytes([red, green, blue, 0])));
        expected[0].push(levels(settings.quantize.levels(scene.background)));
        expected[0].push(single(scene.viewed(&settings).moved_by()));
        expected[0].push(single(Camera::new(&scene.viewed(&settings)).position_error(unit)));
        for (sphere, of) in scene.spheres.iter().zip(1..) {
            expected[of].push(levels(settings.quantize.levels(scene.ambient * sphere.color * sphere.ka)));
        }
        assert_eq!(
            echo_layout(&gpu, &scene.viewed(&settings), &effects, kernel).unwrap(),
            expected.concat(),
            "{kernel:?}"
        );
    }
}
