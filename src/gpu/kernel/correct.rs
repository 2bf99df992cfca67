//! Quotients and square roots that are rounded as IEEE 754 has it, on devices whose own are some units in the last place off, as
//! Vulkan lets them be.
//!
//! What is left of a dividend after the product of quotient and divisor is known to the last bit from an error-free transform
//! (Dekker, "A Floating-Point Technique for Extending the Available Precision", 1971). Divided once more it is what the quotient
//! lacks. Likewise half of what is left of a number after the square of its root, over the root.
//!
//! Only where the exact value lies within some millionths of a unit of the middle between two numbers may the neighbour come out.

use std::collections::HashMap;

use rspirv::binary::Assemble;
use rspirv::dr::{self, Instruction, Operand};
use rspirv::spirv::{Decoration, GlslStd450Op, Op, Word};

use super::constants::{Constants, Values, is_inexact};

/// Splits a number into halves whose products are exact.
const SPLIT: Values = (4097.0, 134_217_729.0);
/// No quotient lacks as much of itself; where numbers are out of the range of the transform, the device's own value stands.
const MOST: Values = (1.0 / (1 << 18) as f32, 1.0 / (1_u64 << 46) as f64);
/// What is divided is greater than this, so that nothing of the transform underflows.
const LEAST: Values = (1e-23, 1e-270);

/// The kernel with each quotient and square root of numbers of so many bits corrected.
pub(super) fn corrected(words: Vec<u32>, is_corrected: impl Fn(u32) -> bool) -> Result<Vec<u32>, String> {
    let mut module = dr::load_words(words).map_err(|error| error.to_string())?;
    let import = module.ext_inst_imports.iter().find_map(|import| import.result_id);
    let import = import.ok_or("it imports no extended instructions")?;
    let mut correction = Correction {
        constants: Constants::of(&module),
        import,
        code: Vec::new(),
        exact: Vec::new(),
        own: HashMap::new(),
    };
    for block in module.functions.iter_mut().flat_map(|function| &mut function.blocks) {
        for instruction in std::mem::take(&mut block.instructions) {
            let typed = instruction.result_type.zip(instruction.result_id).filter(|_| is_inexact(&instruction));
            let typed = typed.filter(|(ty, _)| correction.constants.width(*ty).is_some_and(&is_corrected));
            match typed {
                Some((ty, result)) => correction.correct(instruction, ty, result)?,
                None => correction.code.push(instruction),
            }
        }
        block.instructions = std::mem::take(&mut correction.code);
    }
    let Correction { constants, exact, own, .. } = correction;
    constants.declare(&mut module);
    // What was said of a result is said of the device's own.
    for target in module.annotations.iter_mut().filter_map(|annotation| annotation.operands.first_mut()) {
        if let Operand::IdRef(id) = target {
            *id = own.get(id).copied().unwrap_or(*id);
        }
    }
    let decorated = |result| {
        let operands = vec![Operand::IdRef(result), Operand::Decoration(Decoration::NoContraction)];
        Instruction::new(Op::Decorate, None, None, operands)
    };
    module.annotations.extend(exact.into_iter().map(decorated));
    Ok(module.assemble())
}

struct Correction {
    constants: Constants,
    /// The set of extended instructions.
    import: Word,
    /// The block in hand, so far.
    code: Vec<Instruction>,
    /// Results that nothing may be fused for.
    exact: Vec<Word>,
    /// By a corrected result, the device's own.
    own: HashMap<Word, Word>,
}

impl Correction {
    /// Adds `instruction` with its result corrected.
    fn correct(&mut self, mut instruction: Instruction, ty: Word, result: Word) -> Result<(), String> {
        let own = self.constants.id();
        instruction.result_id = Some(own);
        self.own.insert(result, own);
        let (of, by, last) = match instruction.operands[..] {
            [Operand::IdRef(dividend), Operand::IdRef(divisor)] => (dividend, divisor, None),
            [_, _, Operand::IdRef(square)] => (square, own, Some(own)),
            _ => return Err("a quotient without operands".into()),
        };
        self.code.push(instruction);
        let rest = self.rest(ty, of, own, by)?;
        let divisor = match last {
            Some(root) => self.rounded(Op::FAdd, ty, [root, root]),
            None => by,
        };
        let lacks = self.rounded(Op::FDiv, ty, [rest, divisor]);
        let sum = self.rounded(Op::FAdd, ty, [own, lacks]);
        let [size, lacked, whole] = [own, lacks, of].map(|value| self.absolute(ty, value));
        let (most, least) = (self.constants.constant(ty, MOST)?, self.constants.constant(ty, LEAST)?);
        let most = self.rounded(Op::FMul, ty, [size, most]);
        let truth = self.constants.truth(ty)?;
        // NaN is neither.
        let is_small = self.operation(Op::FOrdLessThan, truth, &[lacked, most]);
        let is_great = self.operation(Op::FOrdGreaterThan, truth, &[whole, least]);
        let counts = self.operation(Op::LogicalAnd, truth, &[is_small, is_great]);
        let operands = [counts, sum, own].map(Operand::IdRef).to_vec();
        self.code.push(Instruction::new(Op::Select, Some(ty), Some(result), operands));
        Ok(())
    }

    /// `of` less the product of `a` and `b`, which is about the same.
    fn rest(&mut self, ty: Word, of: Word, a: Word, b: Word) -> Result<Word, String> {
        let product = self.rounded(Op::FMul, ty, [a, b]);
        let ([a_high, a_low], [b_high, b_low]) = (self.halves(ty, a)?, self.halves(ty, b)?);
        let highs = self.rounded(Op::FMul, ty, [a_high, b_high]);
        let mut error = self.rounded(Op::FSub, ty, [highs, product]);
        for pair in [[a_high, b_low], [a_low, b_high], [a_low, b_low]] {
            let part = self.rounded(Op::FMul, ty, pair);
            error = self.rounded(Op::FAdd, ty, [error, part]);
        }
        let rest = self.rounded(Op::FSub, ty, [of, product]);
        Ok(self.rounded(Op::FSub, ty, [rest, error]))
    }

    /// The halves of a number (Veltkamp).
    fn halves(&mut self, ty: Word, value: Word) -> Result<[Word; 2], String> {
        let split = self.constants.constant(ty, SPLIT)?;
        let wide = self.rounded(Op::FMul, ty, [value, split]);
        let excess = self.rounded(Op::FSub, ty, [wide, value]);
        let high = self.rounded(Op::FSub, ty, [wide, excess]);
        Ok([high, self.rounded(Op::FSub, ty, [value, high])])
    }

    fn absolute(&mut self, ty: Word, value: Word) -> Word {
        let result = self.constants.id();
        let operation = Operand::LiteralExtInstInteger(GlslStd450Op::FAbs as u32);
        let operands = vec![Operand::IdRef(self.import), operation, Operand::IdRef(value)];
        self.code.push(Instruction::new(Op::ExtInst, Some(ty), Some(result), operands));
        result
    }

    fn rounded(&mut self, opcode: Op, ty: Word, operands: [Word; 2]) -> Word {
        let result = self.operation(opcode, ty, &operands);
        self.exact.push(result);
        result
    }

    fn operation(&mut self, opcode: Op, ty: Word, operands: &[Word]) -> Word {
        let result = self.constants.id();
        let operands = operands.iter().copied().map(Operand::IdRef).collect();
        self.code.push(Instruction::new(opcode, Some(ty), Some(result), operands));
        result
    }
}
