//! From a module with constants of the pipeline to the SPIR-V of one kernel, in which every arithmetic operation is rounded as it
//! is written.
//!
//! WGSL lets a driver fuse, reorder and leave out operations, and drivers do so differently where a kernel differs in something
//! else. SPIR-V has a decoration that forbids it, which naga does not write.

use std::num::NonZeroU32;

use naga::back::spv;
use naga::compact::{KeepUnused, compact};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Block, Expression, Handle, Literal, ResourceBinding, ShaderStage, Statement};

use super::shader::Module;

/// A module that is parsed.
#[derive(Debug)]
pub struct Parsed {
    module: naga::Module,
    info: ModuleInfo,
}

impl Parsed {
    /// Parses `module`; an error names the file and line.
    pub fn new(module: &Module) -> Result<Self, String> {
        let module = module.parse()?;
        // What has constants is validated with them.
        let info = validated(&module, ValidationFlags::empty())?;
        Ok(Self { module, info })
    }

    /// The module with this compute entry point alone, these constants, and without what they exclude: drivers take time to
    /// translate what never runs, and they do so at each start.
    pub fn specialised(&self, entry_point: &str, constants: &[(&str, f64)]) -> Result<naga::Module, String> {
        let constants = constants.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
        let entry = Some((ShaderStage::Compute, entry_point));
        let (module, _) =
            naga::back::pipeline_constants::process_overrides(&self.module, &self.info, entry, &constants)
                .map_err(|error| error.to_string())?;
        let mut module = module.into_owned();
        let naga::Module { functions, entry_points, constants, global_expressions, .. } = &mut module;
        let functions = functions.iter_mut().map(|(_, function)| function);
        for function in functions.chain(entry_points.iter_mut().map(|entry| &mut entry.function)) {
            let known = |condition: Handle<Expression>| match function.expressions[condition] {
                Expression::Literal(Literal::Bool(value)) => Some(value),
                Expression::Constant(constant) => match global_expressions[constants[constant].init] {
                    Expression::Literal(Literal::Bool(value)) => Some(value),
                    _ => None,
                },
                _ => None,
            };
            // Names would keep what has them alive.
            function.named_expressions.clear();
            function.body = without_dead(std::mem::take(&mut function.body), &known);
        }
        compact(&mut module, KeepUnused::No);
        Ok(module)
    }

    /// The SPIR-V of this kernel. `bindings` are those of its layout, in ascending order.
    pub fn spirv(&self, entry_point: &str, constants: &[(&str, f64)], bindings: &[u32]) -> Result<Vec<u32>, String> {
        let module = self.specialised(entry_point, constants)?;
        let info = validated(&module, ValidationFlags::all())?;
        // wgpu numbers the bindings of a layout anew.
        let places = bindings.iter().zip(0..).map(|(&binding, place)| {
            let place = spv::BindingInfo { descriptor_set: 0, binding: place, binding_array_size: None };
            (ResourceBinding { group: 0, binding }, place)
        });
        // Without checks, for the reasons that Gpu::shader_module gives.
        let unchecked = BoundsCheckPolicy::Unchecked;
        let options = spv::Options {
            flags: spv::WriterFlags::empty(),
            fake_missing_bindings: false,
            binding_map: places.collect(),
            bounds_check_policies: BoundsCheckPolicies {
                index: unchecked,
                buffer: unchecked,
                image_load: unchecked,
                binding_array: unchecked,
            },
            zero_initialize_workgroup_memory: spv::ZeroInitializeWorkgroupMemoryMode::None,
            force_loop_bounding: false,
            emit_int_div_checks: false,
            ..spv::Options::default()
        };
        let entry = spv::PipelineOptions { shader_stage: ShaderStage::Compute, entry_point: entry_point.to_owned() };
        let words = spv::write_vec(&module, &info, &options, Some(&entry)).map_err(|error| error.to_string())?;
        Ok(without_contraction(&words))
    }
}

fn validated(module: &naga::Module, flags: ValidationFlags) -> Result<ModuleInfo, String> {
    let capabilities = Capabilities::FLOAT64 | Capabilities::SHADER_INT64;
    Validator::new(flags, capabilities).validate(module).map_err(|error| error.to_string())
}

/// The statements without the branches of conditions that are known.
fn without_dead(block: Block, known: &impl Fn(Handle<Expression>) -> Option<bool>) -> Block {
    let mut live = Block::with_capacity(block.len());
    for (statement, span) in block.span_into_iter() {
        match statement {
            Statement::If { condition, accept, reject } => {
                let [accept, reject] = [accept, reject].map(|branch| without_dead(branch, known));
                match known(condition) {
                    Some(true) => live.extend_block(accept),
                    Some(false) => live.extend_block(reject),
                    None => live.push(Statement::If { condition, accept, reject }, span),
                }
            }
            Statement::Block(block) => live.push(Statement::Block(without_dead(block, known)), span),
            Statement::Loop { body, continuing, break_if } => {
                let [body, continuing] = [body, continuing].map(|block| without_dead(block, known));
                live.push(Statement::Loop { body, continuing, break_if }, span);
            }
            other => live.push(other, span),
        }
        // Nothing follows what a known condition leaves at once.
        if let Some(Statement::Return { .. } | Statement::Break | Statement::Continue | Statement::Kill) = live.last() {
            break;
        }
    }
    live
}

/// Words before the first instruction of a module.
const HEADER: usize = 5;

// Instructions and the decoration by their numbers in the SPIR-V specification, section 3.
const OP_EXT_INST: u32 = 12;
const OP_TYPES: std::ops::RangeInclusive<u32> = 19..=39;
const OP_DECORATE: u32 = 71;
const OP_FLOAT_ARITHMETIC: [u32; 9] = [
    127, // OpFNegate
    129, // OpFAdd
    131, // OpFSub
    133, // OpFMul
    136, // OpFDiv
    140, // OpFRem
    142, // OpVectorTimesScalar
    148, // OpDot
    OP_EXT_INST,
];
const NO_CONTRACTION: u32 = 42;

/// The module with the decoration `NoContraction` on the result of each operation on floating-point numbers.
fn without_contraction(words: &[u32]) -> Vec<u32> {
    let mut decorations = Vec::new();
    let mut first_type = None;
    let mut at = HEADER;
    while let Some(length) = words.get(at).and_then(|word| NonZeroU32::new(word >> 16)) {
        let operation = words[at] & 0xffff;
        if first_type.is_none() && OP_TYPES.contains(&operation) {
            first_type = Some(at);
        }
        if OP_FLOAT_ARITHMETIC.contains(&operation) {
            // After the word of the instruction and that of the type.
            decorations.extend([3 << 16 | OP_DECORATE, words[at + 2], NO_CONTRACTION]);
        }
        at += length.get() as usize;
    }
    // Decorations go before types.
    let (before, after) = words.split_at(first_type.unwrap_or(words.len()));
    [before, &decorations, after].concat()
}
