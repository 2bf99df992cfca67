//! From a module with constants of the pipeline to the SPIR-V of one kernel, in which every arithmetic operation is rounded as it
//! is written, and which calls no functions.
//!
//! WGSL lets a driver fuse, reorder and leave out operations, and drivers do so differently where a kernel differs in something
//! else. SPIR-V has a decoration that forbids it, which naga does not write. Instructions that stand for several operations are
//! written out, since drivers choose themselves how to expand them. What is left to the device is how it divides and takes square
//! roots, which Vulkan lets be some units in the last place off.

use std::collections::BTreeSet;

use naga::back::spv;
use naga::compact::{KeepUnused, compact};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Block, Expression, Handle, Literal, ResourceBinding, ShaderStage, Span, Statement};
use rspirv::binary::Assemble;
use rspirv::dr::{self, Operand};
use rspirv::spirv::{Decoration, Op};

use super::inline::inline_calls;
use super::module::Module;
use super::products::expand_products;

/// A module that is parsed.
#[derive(Debug)]
pub struct ParsedModule {
    module: naga::Module,
    info: ModuleInfo,
    /// Whether drivers may fuse, reorder and leave out operations.
    contractible: bool,
    /// The kernel that will most likely be asked for.
    translation: Option<Translation>,
}

/// One kernel of a module.
#[derive(Debug)]
pub(super) struct Translation {
    entry_point: &'static str,
    constants: Vec<(&'static str, f64)>,
    /// Its module with these constants.
    pub(super) module: naga::Module,
    /// Its SPIR-V.
    pub(super) words: Vec<u32>,
}

impl ParsedModule {
    /// Parses `module`; an error names the file and line.
    pub fn new(module: &Module) -> Result<Self, String> {
        let _span = tracing::info_span!("parse shader").entered();
        let module = module.parse()?;
        // What has constants is validated with them.
        let info = validated(&module, ValidationFlags::empty())?;
        Ok(Self { module, info, contractible: false, translation: None })
    }

    /// With one kernel translated, before there is a device to ask for it.
    pub(super) fn with_translation(
        self,
        entry_point: &'static str,
        constants: Vec<(&'static str, f64)>,
    ) -> Result<Self, String> {
        let module = self.specialised(entry_point, &constants)?;
        let words = self.spirv(&module, entry_point)?;
        Ok(Self { translation: Some(Translation { entry_point, constants, module, words }), ..self })
    }

    /// The translation of this kernel, if it is the one that there is.
    pub(super) fn translation(&self, entry_point: &str, constants: &[(&str, f64)]) -> Option<&Translation> {
        self.translation.as_ref().filter(|it| it.entry_point == entry_point && it.constants == constants)
    }

    /// From now on drivers may fuse, reorder and leave out operations: for study only.
    pub(crate) fn contractible(self) -> Self {
        Self { contractible: true, ..self }
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
            join_returns(&mut function.body);
        }
        compact(&mut module, KeepUnused::No);
        Ok(module)
    }

    /// The SPIR-V of this entry point of `module`, which is this one specialised.
    pub fn spirv(&self, module: &naga::Module, entry_point: &str) -> Result<Vec<u32>, String> {
        let info = validated(module, ValidationFlags::all())?;
        // wgpu numbers the bindings of a layout anew, in their order.
        let bound: BTreeSet<ResourceBinding> =
            module.global_variables.iter().filter_map(|(_, it)| it.binding).collect();
        let place = |place| spv::BindingInfo { descriptor_set: 0, binding: place, binding_array_size: None };
        let places = bound.into_iter().zip((0..).map(place));
        // Checks cost up to 30 %: every index is below a length that the host set with the buffers, every loop counts up to a
        // bound, no integer is divided by 0.
        let unchecked = BoundsCheckPolicy::Unchecked;
        let options = spv::Options {
            // Later versions than 1.4 forbid that what is in a buffer and a variable of the kernel have the same type.
            lang_version: (1, 0),
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
        let words = spv::write_vec(module, &info, &options, Some(&entry)).map_err(|error| error.to_string())?;
        let mut module = dr::load_words(words).map_err(|error| error.to_string())?;
        inline_calls(&mut module);
        expand_products(&mut module);
        if !self.contractible {
            forbid_contraction(&mut module);
        }
        Ok(module.assemble())
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

/// naga's front end lets each branch at the end of a function return by itself: once behind them instead, so that the function can
/// be inlined. Whether `block` now ends with a return without a value.
fn join_returns(block: &mut Block) -> bool {
    if let Some(Statement::If { accept, reject, .. }) = block.last_mut()
        && [&mut *accept, &mut *reject].map(join_returns) == [true; 2]
    {
        for branch in [accept, reject] {
            branch.cull(branch.len() - 1..);
        }
        block.push(Statement::Return { value: None }, Span::default());
    }
    matches!(block.last(), Some(Statement::Return { value: None }))
}

/// The operations on floating-point numbers whose result is rounded, as far as kernels have them; the square root is among the
/// extended instructions.
const ROUNDED: [Op; 7] = [Op::FNegate, Op::FAdd, Op::FSub, Op::FMul, Op::FDiv, Op::VectorTimesScalar, Op::ExtInst];

/// Decorates the result of each operation on floating-point numbers with `NoContraction`.
fn forbid_contraction(module: &mut dr::Module) {
    let instructions = module.functions.iter().flat_map(dr::Function::all_inst_iter);
    let results = instructions.filter(|it| ROUNDED.contains(&it.class.opcode)).filter_map(|it| it.result_id);
    let exact = |result| {
        let operands = vec![Operand::IdRef(result), Operand::Decoration(Decoration::NoContraction)];
        dr::Instruction::new(Op::Decorate, None, None, operands)
    };
    module.annotations.extend(results.map(exact));
}
