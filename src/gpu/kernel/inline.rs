//! Functions put in the place of their calls. Drivers do so too, but Mesa's takes several times as long to translate a kernel with
//! a hundred calls as to translate the same kernel without.

use std::collections::HashMap;

use rspirv::dr::{Block, Function, Instruction, Module, Operand};
use rspirv::spirv::Op;

/// Puts functions in the place of their calls and drops those that nobody calls any more.
///
/// Calls of functions that return before their end stay. Decorations of what is in a function are not copied: only types and
/// variables of the module may have some yet.
pub(super) fn inline_calls(module: &mut Module) {
    let Some(header) = &mut module.header else { return };
    let functions = || module.functions.iter().filter_map(|function| Some((function.def_id()?, function)));
    let inlinable = functions().filter(|(_, function)| can_be_inlined(function)).collect();
    let mut inliner = Inliner { inlinable, bound: header.bound, next_id: header.bound };
    let mut wanted: Vec<u32> = module.entry_points.iter().flat_map(ids).collect();
    let mut kept = Vec::new();
    // Functions come before those that call them.
    for (id, function) in functions().rev() {
        if wanted.contains(&id) {
            let function = inliner.without_calls(function);
            wanted.extend(function.all_inst_iter().filter_map(called));
            kept.push(function);
        }
    }
    kept.reverse();
    header.bound = inliner.next_id;
    module.functions = kept;
}

/// Whether a function returns at its end and nowhere else.
fn can_be_inlined(function: &Function) -> bool {
    let last = function.blocks.iter().filter_map(|block| block.instructions.last());
    let mut returns = last.rev().map(|last| matches!(last.class.opcode, Op::Return | Op::ReturnValue));
    returns.next() == Some(true) && !returns.any(|returns| returns) && !has_phi(function)
}

/// Whether values depend on the block before, which inlining changes; naga writes none where it checks no bounds.
fn has_phi(function: &Function) -> bool {
    function.blocks.iter().flat_map(|block| &block.instructions).any(|it| it.class.opcode == Op::Phi)
}

/// The ids that an instruction refers to.
fn ids(instruction: &Instruction) -> impl Iterator<Item = u32> {
    instruction.operands.iter().filter_map(|operand| match operand {
        Operand::IdRef(id) => Some(*id),
        _ => None,
    })
}

/// The function that an instruction calls.
fn called(instruction: &Instruction) -> Option<u32> {
    (instruction.class.opcode == Op::FunctionCall).then(|| ids(instruction).next()).flatten()
}

struct Inliner<'a> {
    inlinable: HashMap<u32, &'a Function>,
    /// One more than the greatest id of the module, and the next one of a copy.
    bound: u32,
    next_id: u32,
}

/// What a function becomes.
#[derive(Default)]
struct Inlined {
    variables: Vec<Instruction>,
    blocks: Vec<Block>,
}

impl Inlined {
    fn push(&mut self, instruction: Instruction) {
        if let Some(block) = self.blocks.last_mut() {
            block.instructions.push(instruction);
        }
    }
}

/// The ids in a copy by those in the original.
struct IdMap(Vec<u32>);

impl IdMap {
    fn of(&self, id: u32) -> u32 {
        self.0[id as usize]
    }

    fn renamed(&self, instruction: &Instruction) -> Instruction {
        let mut copy = instruction.clone();
        copy.result_id = copy.result_id.map(|id| self.of(id));
        for operand in &mut copy.operands {
            if let Operand::IdRef(id) = operand {
                *id = self.of(*id);
            }
        }
        copy
    }
}

impl Inliner<'_> {
    fn without_calls(&mut self, function: &Function) -> Function {
        let Some(first) = function.blocks.first().filter(|_| !has_phi(function)) else { return function.clone() };
        let mut body = Inlined::default();
        body.blocks.push(Block { label: first.label.clone(), instructions: Vec::new() });
        let names = IdMap((0..self.bound).collect());
        self.copy(function, names, &mut body, false);
        let Inlined { variables, mut blocks } = body;
        blocks[0].instructions.splice(0..0, variables);
        Function {
            def: function.def.clone(),
            end: function.end.clone(),
            parameters: function.parameters.clone(),
            blocks,
        }
    }

    /// Goes on in `body` with what `function` does, and gives its value where that is not where `body` returns.
    fn copy(&mut self, function: &Function, mut names: IdMap, body: &mut Inlined, is_called: bool) -> Option<u32> {
        let mut value = None;
        for (index, block) in function.blocks.iter().enumerate() {
            if index > 0 {
                let label = block.label.as_ref().map(|label| names.renamed(label));
                body.blocks.push(Block { label, instructions: Vec::new() });
            }
            // What declares a loop has to stay in the block that begins it; naga calls nothing there.
            let begins_loop = block.instructions.iter().any(|instruction| instruction.class.opcode == Op::LoopMerge);
            for instruction in &block.instructions {
                let callee = called(instruction).and_then(|id| self.inlinable.get(&id).copied());
                if let Some(callee) = callee.filter(|_| !begins_loop) {
                    let own = self.names(callee, ids(instruction).skip(1).map(|id| names.of(id)));
                    let value = self.copy(callee, own, body, true);
                    if let Some((result, value)) = instruction.result_id.zip(value) {
                        names.0[result as usize] = value;
                    }
                    continue;
                }
                let mut copy = names.renamed(instruction);
                match copy.class.opcode {
                    Op::Variable => {
                        // It begins anew with each call.
                        let initial = copy.operands.drain(1..).next();
                        if let Some((variable, initial)) = copy.result_id.zip(initial) {
                            let operands = vec![Operand::IdRef(variable), initial];
                            body.push(Instruction::new(Op::Store, None, None, operands));
                        }
                        body.variables.push(copy);
                    }
                    Op::Return | Op::ReturnValue if is_called => value = ids(&copy).next(),
                    _ => body.push(copy),
                }
            }
        }
        value
    }

    /// New ids for all that `function` has, and those of the arguments for its parameters.
    fn names(&mut self, function: &Function, arguments: impl Iterator<Item = u32>) -> IdMap {
        let mut names: Vec<u32> = (0..self.bound).collect();
        let parameters = function.parameters.iter().filter_map(|parameter| parameter.result_id);
        for (parameter, argument) in parameters.zip(arguments) {
            names[parameter as usize] = argument;
        }
        let body = function.blocks.iter().flat_map(|block| block.label.iter().chain(&block.instructions));
        for result in body.filter_map(|instruction| instruction.result_id) {
            names[result as usize] = self.next_id;
            self.next_id += 1;
        }
        IdMap(names)
    }
}
