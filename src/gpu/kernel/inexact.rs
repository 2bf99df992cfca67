//! Quotients and square roots that are off by some units in the last place, to see what the program makes of a device whose own are.

use rspirv::binary::Assemble;
use rspirv::dr::{self, Instruction, Operand};
use rspirv::spirv::Op;

use super::constants::{Constants, is_inexact};

/// The kernel with each quotient and square root too small by so many units in the last place, half as many where it is barely a power
/// of two.
pub(super) fn made_inexact(words: Vec<u32>, units: u32) -> Result<Vec<u32>, String> {
    let mut module = dr::load_words(words).map_err(|error| error.to_string())?;
    let mut constants = Constants::of(&module);
    let below_one = (f32::from_bits(1.0_f32.to_bits() - units), f64::from_bits(1.0_f64.to_bits() - u64::from(units)));
    for block in module.functions.iter_mut().flat_map(|function| &mut function.blocks) {
        let mut instructions = Vec::with_capacity(block.instructions.len());
        for mut instruction in std::mem::take(&mut block.instructions) {
            let typed = instruction.result_type.zip(instruction.result_id).filter(|_| is_inexact(&instruction));
            let Some((ty, result)) = typed else {
                instructions.push(instruction);
                continue;
            };
            let (right, factor) = (constants.id(), constants.constant(ty, below_one)?);
            instruction.result_id = Some(right);
            instructions.push(instruction);
            let operands = vec![Operand::IdRef(right), Operand::IdRef(factor)];
            instructions.push(Instruction::new(Op::FMul, Some(ty), Some(result), operands));
        }
        block.instructions = instructions;
    }
    constants.declare(&mut module);
    Ok(module.assemble())
}
