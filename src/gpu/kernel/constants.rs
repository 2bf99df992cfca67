//! Constants of floating-point numbers that are added to a kernel's SPIR-V.

use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Op, Word};

/// The values of one constant in both kinds of numbers.
pub(super) type Values = (f32, f64);

/// What is added to a module's declarations.
#[derive(Debug)]
pub(super) struct Constants {
    types: Vec<Instruction>,
    /// New declarations, in their order.
    added: Vec<Instruction>,
    known: Vec<(Word, u64, Word)>,
    next: Word,
}

impl Constants {
    /// None yet.
    pub(super) fn of(module: &Module) -> Self {
        let types = module.types_global_values.clone();
        let next = module.header.as_ref().map_or(0, |header| header.bound);
        Self { types, added: Vec::new(), known: Vec::new(), next }
    }

    /// A number that is not in use yet.
    pub(super) fn id(&mut self) -> Word {
        self.next += 1;
        self.next - 1
    }

    /// How many bits a number of this type has, or the components of this type of vectors.
    pub(super) fn width(&self, ty: Word) -> Option<u32> {
        let declared = self.declared(ty)?;
        match (declared.class.opcode, &declared.operands[..]) {
            (Op::TypeFloat, [Operand::LiteralBit32(width), ..]) => Some(*width),
            (Op::TypeVector, [Operand::IdRef(part), _]) => self.width(*part),
            _ => None,
        }
    }

    /// A constant of this type of numbers, or with all components alike of this type of vectors.
    pub(super) fn constant(&mut self, ty: Word, value: Values) -> Result<Word, String> {
        let key = value.1.to_bits();
        if let Some((.., constant)) = self.known.iter().find(|(known, of, _)| (*known, *of) == (ty, key)) {
            return Ok(*constant);
        }
        let (opcode, operands) = match (self.components(ty)?, self.width(ty)) {
            (Some((part, count)), _) => {
                let constant = self.constant(part, value)?;
                (Op::ConstantComposite, vec![Operand::IdRef(constant); count as usize])
            }
            (None, Some(32)) => (Op::Constant, vec![Operand::LiteralBit32(value.0.to_bits())]),
            (None, Some(64)) => (Op::Constant, vec![Operand::LiteralBit64(value.1.to_bits())]),
            (None, _) => return Err(format!("the type {ty} is none of numbers")),
        };
        let constant = self.id();
        self.added.push(Instruction::new(opcode, Some(ty), Some(constant), operands));
        self.known.push((ty, key, constant));
        Ok(constant)
    }

    /// The type of what a comparison of two values of this type gives.
    pub(super) fn truth(&mut self, ty: Word) -> Result<Word, String> {
        let components = self.components(ty)?;
        let bool = self.type_of(Op::TypeBool, &[]);
        Ok(match components {
            Some((_, count)) => self.type_of(Op::TypeVector, &[Operand::IdRef(bool), Operand::LiteralBit32(count)]),
            None => bool,
        })
    }

    /// Declares them in `module`, which has its code again.
    pub(super) fn declare(self, module: &mut Module) {
        module.types_global_values.extend(self.added);
        if let Some(header) = &mut module.header {
            header.bound = self.next;
        }
    }

    fn declared(&self, ty: Word) -> Option<&Instruction> {
        self.types.iter().chain(&self.added).find(|it| it.result_id == Some(ty))
    }

    /// The type and number of a vector's components; `None` for a number.
    fn components(&self, ty: Word) -> Result<Option<(Word, u32)>, String> {
        let declared = self.declared(ty).ok_or_else(|| format!("the type {ty} is not declared"))?;
        Ok(match declared.operands[..] {
            [Operand::IdRef(part), Operand::LiteralBit32(count)] => Some((part, count)),
            _ => None,
        })
    }

    /// The type declared like this, once.
    fn type_of(&mut self, opcode: Op, operands: &[Operand]) -> Word {
        let is_it = |it: &&Instruction| it.class.opcode == opcode && it.operands == operands;
        if let Some(declared) = self.types.iter().chain(&self.added).find(is_it).and_then(|it| it.result_id) {
            return declared;
        }
        let ty = self.id();
        self.added.push(Instruction::new(opcode, None, Some(ty), operands.to_vec()));
        ty
    }
}

/// Whether an operation is a quotient or a square root, which Vulkan lets be some units in the last place off.
pub(super) fn is_inexact(instruction: &Instruction) -> bool {
    match instruction.class.opcode {
        Op::FDiv => true,
        Op::ExtInst => instruction.operands.get(1) == Some(&Operand::LiteralExtInstInteger(SQRT)),
        _ => false,
    }
}

/// The number of `Sqrt` in the set of extended instructions that kernels use, `GLSL.std.450`.
const SQRT: u32 = rspirv::spirv::GlslStd450Op::Sqrt as u32;
