// What a flow is told, and what it tells: the members that all three read alike.

declare const process: { argv: string[] };

interface Result {
  status: string | undefined;
  upstream: number[] | undefined;
  csv: string | undefined;
  picture: number | undefined;
  listed: boolean;
  has_more: boolean | undefined;
  problem: string | undefined;
}

export const told = {
  base: process.argv[2] ?? "",
  nobody: "0190a0b0-0000-7000-8000-000000000001",
  result: (result: Result) => console.log(JSON.stringify(result)),
};
