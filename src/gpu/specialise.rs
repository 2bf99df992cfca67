//! From a module with constants of the pipeline to what one entry point does with them: drivers take time to translate what
//! never runs, and they do so at each start.

use naga::compact::{KeepUnused, compact};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Block, Expression, Handle, Literal, ShaderStage, Statement};

use super::shader::Module;

/// A module that is parsed and valid.
#[derive(Debug)]
pub struct Parsed {
    module: naga::Module,
    info: ModuleInfo,
}

impl Parsed {
    /// Parses and validates `module`; an error names the file and line.
    pub fn new(module: &Module) -> Result<Self, String> {
        let module = module.parse()?;
        let capabilities = Capabilities::FLOAT64 | Capabilities::SHADER_INT64;
        let info = Validator::new(ValidationFlags::all(), capabilities).validate(&module).map_err(|e| e.to_string())?;
        Ok(Self { module, info })
    }

    /// The module with this compute entry point alone, these constants, and without what they exclude.
    pub fn specialised(&self, entry_point: &str, constants: &[(&str, f64)]) -> Result<naga::Module, String> {
        let constants = constants.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
        let entry = Some((ShaderStage::Compute, entry_point));
        let (module, _) =
            naga::back::pipeline_constants::process_overrides(&self.module, &self.info, entry, &constants)
                .map_err(|e| e.to_string())?;
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
