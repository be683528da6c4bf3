// SPDX-License-Identifier: MIT
// The OpenGL 3.3 functions that the renderer uses, looked up at run time. Nothing of GL is linked.
#pragma once

#include <GL/glcorearb.h>

#include <functional>

namespace verisim::render {

// name after `gl`, type of the pointer in glcorearb.h
#define VERISIM_GL_FUNCTIONS(X)                                              \
  X(ActiveTexture, PFNGLACTIVETEXTUREPROC)                                   \
  X(AttachShader, PFNGLATTACHSHADERPROC)                                     \
  X(BindBuffer, PFNGLBINDBUFFERPROC)                                         \
  X(BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)                               \
  X(BindRenderbuffer, PFNGLBINDRENDERBUFFERPROC)                             \
  X(BindTexture, PFNGLBINDTEXTUREPROC)                                       \
  X(BindVertexArray, PFNGLBINDVERTEXARRAYPROC)                               \
  X(BlitFramebuffer, PFNGLBLITFRAMEBUFFERPROC)                               \
  X(BufferData, PFNGLBUFFERDATAPROC)                                         \
  X(CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC)                 \
  X(Clear, PFNGLCLEARPROC)                                                   \
  X(CompileShader, PFNGLCOMPILESHADERPROC)                                   \
  X(CreateProgram, PFNGLCREATEPROGRAMPROC)                                   \
  X(CreateShader, PFNGLCREATESHADERPROC)                                     \
  X(DeleteBuffers, PFNGLDELETEBUFFERSPROC)                                   \
  X(DeleteFramebuffers, PFNGLDELETEFRAMEBUFFERSPROC)                         \
  X(DeleteProgram, PFNGLDELETEPROGRAMPROC)                                   \
  X(DeleteRenderbuffers, PFNGLDELETERENDERBUFFERSPROC)                       \
  X(DeleteShader, PFNGLDELETESHADERPROC)                                     \
  X(DeleteTextures, PFNGLDELETETEXTURESPROC)                                 \
  X(DeleteVertexArrays, PFNGLDELETEVERTEXARRAYSPROC)                         \
  X(Disable, PFNGLDISABLEPROC)                                               \
  X(DrawArrays, PFNGLDRAWARRAYSPROC)                                         \
  X(DrawBuffer, PFNGLDRAWBUFFERPROC)                                         \
  X(DrawElementsInstanced, PFNGLDRAWELEMENTSINSTANCEDPROC)                   \
  X(Enable, PFNGLENABLEPROC)                                                 \
  X(EnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC)               \
  X(FramebufferRenderbuffer, PFNGLFRAMEBUFFERRENDERBUFFERPROC)               \
  X(FramebufferTexture2D, PFNGLFRAMEBUFFERTEXTURE2DPROC)                     \
  X(GenBuffers, PFNGLGENBUFFERSPROC)                                         \
  X(GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)                               \
  X(GenRenderbuffers, PFNGLGENRENDERBUFFERSPROC)                             \
  X(GenTextures, PFNGLGENTEXTURESPROC)                                       \
  X(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)                               \
  X(GetError, PFNGLGETERRORPROC)                                             \
  X(GetProgramInfoLog, PFNGLGETPROGRAMINFOLOGPROC)                           \
  X(GetProgramiv, PFNGLGETPROGRAMIVPROC)                                     \
  X(GetRenderbufferParameteriv, PFNGLGETRENDERBUFFERPARAMETERIVPROC)         \
  X(GetShaderInfoLog, PFNGLGETSHADERINFOLOGPROC)                             \
  X(GetShaderiv, PFNGLGETSHADERIVPROC)                                       \
  X(GetString, PFNGLGETSTRINGPROC)                                           \
  X(GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC)                         \
  X(LinkProgram, PFNGLLINKPROGRAMPROC)                                       \
  X(PixelStorei, PFNGLPIXELSTOREIPROC)                                       \
  X(PolygonOffset, PFNGLPOLYGONOFFSETPROC)                                   \
  X(ReadBuffer, PFNGLREADBUFFERPROC)                                         \
  X(ReadPixels, PFNGLREADPIXELSPROC)                                         \
  X(RenderbufferStorageMultisample, PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC) \
  X(ShaderSource, PFNGLSHADERSOURCEPROC)                                     \
  X(TexImage2D, PFNGLTEXIMAGE2DPROC)                                         \
  X(TexParameteri, PFNGLTEXPARAMETERIPROC)                                   \
  X(Uniform1f, PFNGLUNIFORM1FPROC)                                           \
  X(Uniform1i, PFNGLUNIFORM1IPROC)                                           \
  X(Uniform2f, PFNGLUNIFORM2FPROC)                                           \
  X(Uniform3f, PFNGLUNIFORM3FPROC)                                           \
  X(Uniform4f, PFNGLUNIFORM4FPROC)                                           \
  X(UniformMatrix3fv, PFNGLUNIFORMMATRIX3FVPROC)                             \
  X(UniformMatrix4fv, PFNGLUNIFORMMATRIX4FVPROC)                             \
  X(UseProgram, PFNGLUSEPROGRAMPROC)                                         \
  X(VertexAttrib4f, PFNGLVERTEXATTRIB4FPROC)                                 \
  X(VertexAttribDivisor, PFNGLVERTEXATTRIBDIVISORPROC)                       \
  X(VertexAttribPointer, PFNGLVERTEXATTRIBPOINTERPROC)                       \
  X(Viewport, PFNGLVIEWPORTPROC)

/// Finds a GL function by its full name in the current context; null where it is missing.
using GetProcAddress = std::function<void*(const char* name)>;

/// Pointers to GL functions: `gl.Clear(...)` is glClear.
struct Gl {
#define VERISIM_GL_MEMBER(name, type) type name = nullptr;
  VERISIM_GL_FUNCTIONS(VERISIM_GL_MEMBER)
#undef VERISIM_GL_MEMBER
};

/// Loads every function of the table for the current context.
/// Throws RenderError naming all that are missing.
Gl load_gl(const GetProcAddress& get_proc_address);

}  // namespace verisim::render
