//! Scalar and vector products as the products and sums that they are written for.
//!
//! SPIR-V has one instruction for each, which drivers expand as they like: Mesa into fused multiply-adds where the processor has
//! them, `NoContraction` or not. What stands for them here is decorated like all other arithmetic.

use std::collections::HashMap;

use rspirv::dr::{Function, Instruction, Module, Operand};
use rspirv::spirv::{GlslStd450Op, Op};

/// Puts (x + y) + z of the products of the components in the place of a · b, and a.yzx b.zxy − a.zxy b.yzx in that of a × b.
pub(super) fn expand_products(module: &mut Module) {
    let Some(header) = &mut module.header else { return };
    let typed = |it: &Instruction| it.result_id.zip(it.result_type);
    let globals = module.types_global_values.iter();
    let locals = module.functions.iter().flat_map(Function::all_inst_iter);
    let types = globals.clone().chain(locals).filter_map(typed).collect();
    let sizes = globals.filter(|it| it.class.opcode == Op::TypeVector).filter_map(|it| it.result_id.zip(size_of(it)));
    let mut expansion = Expansion { types, sizes: sizes.collect(), next_id: header.bound };
    for block in module.functions.iter_mut().flat_map(|function| &mut function.blocks) {
        let instructions = std::mem::take(&mut block.instructions);
        block.instructions = instructions.into_iter().flat_map(|it| expansion.of(it)).collect();
    }
    header.bound = expansion.next_id;
}

/// The number of components of a vector type.
fn size_of(vector: &Instruction) -> Option<u32> {
    match vector.operands[..] {
        [_, Operand::LiteralBit32(size)] => Some(size),
        _ => None,
    }
}

struct Expansion {
    /// The type of each value.
    types: HashMap<u32, u32>,
    /// The number of components of each vector type.
    sizes: HashMap<u32, u32>,
    next_id: u32,
}

impl Expansion {
    /// What stands for `instruction`.
    fn of(&mut self, instruction: Instruction) -> Vec<Instruction> {
        let Some((result, ty)) = instruction.result_id.zip(instruction.result_type) else { return vec![instruction] };
        match (instruction.class.opcode, &instruction.operands[..]) {
            (Op::Dot, &[Operand::IdRef(a), Operand::IdRef(b)]) => {
                self.dot(result, ty, a, b).unwrap_or_else(|| vec![instruction])
            }
            (Op::ExtInst, &[_, Operand::LiteralExtInstInteger(operation), Operand::IdRef(a), Operand::IdRef(b)])
                if operation == GlslStd450Op::Cross as u32 =>
            {
                self.cross(result, ty, a, b)
            }
            _ => vec![instruction],
        }
    }

    fn id(&mut self) -> u32 {
        self.next_id += 1;
        self.next_id - 1
    }

    fn dot(&mut self, result: u32, ty: u32, a: u32, b: u32) -> Option<Vec<Instruction>> {
        let vector = *self.types.get(&a)?;
        let size = *self.sizes.get(&vector)?;
        let products = self.id();
        let mut code = vec![operation(Op::FMul, vector, products, [a, b])];
        let mut sum = None;
        for index in 0..size {
            let product = self.id();
            let operands = vec![Operand::IdRef(products), Operand::LiteralBit32(index)];
            code.push(Instruction::new(Op::CompositeExtract, Some(ty), Some(product), operands));
            sum = Some(match sum {
                None => product,
                Some(sum) => {
                    let next = if index + 1 == size { result } else { self.id() };
                    code.push(operation(Op::FAdd, ty, next, [sum, product]));
                    next
                }
            });
        }
        Some(code)
    }

    fn cross(&mut self, result: u32, ty: u32, a: u32, b: u32) -> Vec<Instruction> {
        let (yzx, zxy) = ([1, 2, 0], [2, 0, 1]);
        let mut code = Vec::new();
        let mut product = |first, second| {
            let [a, b] = [(a, first), (b, second)].map(|(vector, order): (u32, [u32; 3])| {
                let turned = self.id();
                let operands = [vector; 2].map(Operand::IdRef).into_iter().chain(order.map(Operand::LiteralBit32));
                code.push(Instruction::new(Op::VectorShuffle, Some(ty), Some(turned), operands.collect()));
                turned
            });
            let product = self.id();
            code.push(operation(Op::FMul, ty, product, [a, b]));
            product
        };
        let products = [product(yzx, zxy), product(zxy, yzx)];
        code.push(operation(Op::FSub, ty, result, products));
        code
    }
}

fn operation(op: Op, ty: u32, result: u32, operands: [u32; 2]) -> Instruction {
    Instruction::new(op, Some(ty), Some(result), operands.map(Operand::IdRef).to_vec())
}
