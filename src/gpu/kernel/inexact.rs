//! Quotients and square roots that are off by some units in the last place, to see what the program makes of a device whose own are.

use rspirv::binary::Assemble;
use rspirv::dr::{self, Operand};
use rspirv::spirv::{Op, Word};

/// The number of `Sqrt` in the set of extended instructions that kernels use, `GLSL.std.450`.
const SQRT: u32 = 31;

/// The kernel with each quotient and square root too small by so many units in the last place, half as many where it is barely a power
/// of two.
pub(super) fn made_inexact(words: Vec<u32>, units: u32) -> Result<Vec<u32>, String> {
    let mut module = dr::load_words(words).map_err(|error| error.to_string())?;
    let mut factors = Factors { module: dr::Module::new(), next: 0, units, known: Vec::new() };
    std::mem::swap(&mut factors.module, &mut module);
    factors.next = factors.module.header.as_ref().map_or(0, |header| header.bound);
    let mut functions = std::mem::take(&mut factors.module.functions);
    for block in functions.iter_mut().flat_map(|function| &mut function.blocks) {
        let mut instructions = Vec::with_capacity(block.instructions.len());
        for mut instruction in std::mem::take(&mut block.instructions) {
            let (Some(ty), Some(result)) =
                (instruction.result_type, instruction.result_id.filter(|_| is_inexact(&instruction)))
            else {
                instructions.push(instruction);
                continue;
            };
            let (right, factor) = (factors.id(), factors.of(ty)?);
            instruction.result_id = Some(right);
            instructions.push(instruction);
            let operands = vec![Operand::IdRef(right), Operand::IdRef(factor)];
            instructions.push(dr::Instruction::new(Op::FMul, Some(ty), Some(result), operands));
        }
        block.instructions = instructions;
    }
    let Factors { mut module, next, .. } = factors;
    module.functions = functions;
    if let Some(header) = &mut module.header {
        header.bound = next;
    }
    Ok(module.assemble())
}

fn is_inexact(instruction: &dr::Instruction) -> bool {
    match instruction.class.opcode {
        Op::FDiv => true,
        Op::ExtInst => instruction.operands.get(1) == Some(&Operand::LiteralExtInstInteger(SQRT)),
        _ => false,
    }
}

/// The constants that many units below 1, of each type.
struct Factors {
    module: dr::Module,
    next: Word,
    units: u32,
    known: Vec<(Word, Word)>,
}

impl Factors {
    fn id(&mut self) -> Word {
        self.next += 1;
        self.next - 1
    }

    /// That of this type of numbers or vectors.
    fn of(&mut self, ty: Word) -> Result<Word, String> {
        if let Some((_, factor)) = self.known.iter().find(|(known, _)| *known == ty) {
            return Ok(*factor);
        }
        let declared = self.module.types_global_values.iter().find(|it| it.result_id == Some(ty));
        let declared = declared.ok_or_else(|| format!("the type {ty} is not declared"))?.clone();
        let constant = match (declared.class.opcode, &declared.operands[..]) {
            (Op::TypeFloat, [Operand::LiteralBit32(32), ..]) => {
                let bits = 1.0_f32.to_bits() - self.units;
                (Op::Constant, vec![Operand::LiteralBit32(bits)])
            }
            (Op::TypeFloat, _) => {
                let bits = 1.0_f64.to_bits() - u64::from(self.units);
                (Op::Constant, vec![Operand::LiteralBit64(bits)])
            }
            (Op::TypeVector, [Operand::IdRef(part), Operand::LiteralBit32(count)]) => {
                let factor = self.of(*part)?;
                (Op::ConstantComposite, vec![Operand::IdRef(factor); *count as usize])
            }
            (other, _) => return Err(format!("a quotient of type {other:?}")),
        };
        let factor = self.id();
        let (opcode, operands) = constant;
        self.module.types_global_values.push(dr::Instruction::new(opcode, Some(ty), Some(factor), operands));
        self.known.push((ty, factor));
        Ok(factor)
    }
}
