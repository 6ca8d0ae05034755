// Text of a shader with what it includes: ../glsl.ts.
declare module '*?glsl' {
  const text: string;
  export default text;
}
